// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>
#include <array>
#include <complex>
#include <span>
#include <vector>

#include "analysis/diagnosis/vibration/samples.h"

namespace strainwave::analysis::diagnosis {

/// Smooth pulses at even angles, without their mean: Gaussian bells whose harmonics fall off as
/// exp(−(2π · width · k)² / 2). They change as 1 + cosine · cos(slow θ) + sine · sin(slow θ).
struct PulseTrain {
  double order{};  // pulses per input turn
  double width{};  // standard deviation of a bell, in distances of two pulses
  double phase{};  // pulse where angle from mid-record · order / 2π = integer + phase
  double slow_order{};
  double cosine{};
  double sine{};
};

inline constexpr int kPulseHarmonics = 12;

/// Harmonics of a train with this width that lie below half the sampling rate and are not lost in the first.
int PulseHarmonics(double width, double order, double highest_order);

Eigen::VectorXd PulseColumn(const VibrationRun& run, const PulseTrain& train, double highest_order);

/// What a residual of one run has at the harmonics of an order: where even trains of pulses explain most of
/// it.
class PulseLines {
 public:
  PulseLines(const VibrationRun& run, double order, std::span<const double> residual,
             std::span<const double> weights);

  /// Phase of a train of this width and so many harmonics, over the channels together.
  double BestPhase(double width, int harmonics) const;

 private:
  using Lines = std::array<std::complex<double>, kPulseHarmonics + 1>;
  std::vector<Lines> of_channel_;
};

}  // namespace strainwave::analysis::diagnosis
