// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "analysis/diagnosis/records.h"

namespace strainwave::analysis::diagnosis {

/// A segment of a record without gaps, at even steps.
struct EvenSegment {
  std::size_t record{};
  double start_s{};
  double step_s{};
  bool resampled{};  // brought onto even steps: what jumps between two samples has moved within its step
  double stamp_error_s{};  // standard deviation of the samples' times
  std::vector<double> position;
  std::vector<double> torque;
  std::vector<double> velocity;          // empty: none, or none that can be used
  std::vector<double> temperature_degC;  // empty: none
  std::vector<bool> clipped;             // torque at the end of its range, or a spike that was bridged
};

/// Motion records made ready: even steps, one unit for position, what was noticed.
struct MotionSamples {
  std::vector<EvenSegment> segments;
  std::size_t records{};
  bool linear{};
  std::optional<double> inertia;
  double position_noise{};  // standard deviations of the white parts
  double stamp_error_s{};   // of most segments
  double velocity_noise{};
  double torque_noise{};
  double position_step{};                        // of a quantised position; 0 for a continuous one
  std::vector<std::vector<std::size_t>> spikes;  // samples of the torque that were bridged, one list a record
  std::vector<std::string> warnings;

  /// Of the white part of the position at a speed.
  double PositionNoise(double speed) const {
    return std::max(position_noise, stamp_error_s * std::abs(speed));
  }
};

/// @param kept  samples of the torque that are known not to be spikes, one ascending list a record; empty:
///   none.
/// @throws std::invalid_argument for a technician: too short, nothing moves, torque constant or mostly
///   clipped.
MotionSamples PrepareMotion(std::span<const MotionData> records,
                            std::span<const std::vector<std::size_t>> kept = {});

/// Standard deviation of the white part of even samples: median |difference| of the order, from the first to
/// the eighth, that leaves least, so that no motion counts. 0 for fewer than 16 samples.
double WhiteNoiseLevel(std::span<const double> samples);

/// Standard deviation of the times of samples: what of the white part of their position grows with speed. A
/// sample is noisier by its speed times that. 0 where a fast axis is hardly noisier than a slow one, or of
/// fewer than 64 samples. Times rise.
double StampError_s(std::span<const double> time_s, std::span<const double> position);

/// Value below which `share` of |values| lie.
double QuantileOfMagnitude(std::span<const double> values, double share);

/// Standard deviation of values that are normal but for up to a tenth of them, by the magnitude that four
/// fifths stay below: short acceleration transients do not count in it, noise that comes and goes with the
/// speed does.
double UsualSize(std::span<const double> values);

/// Of the 95 % quantile of the speed, from which on an axis moves.
inline constexpr double kMoving = 0.1;

}  // namespace strainwave::analysis::diagnosis
