// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>
#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "analysis/diagnosis/records.h"

namespace strainwave::analysis::diagnosis {

/// One channel of one record, as a segment of the response.
struct VibrationSegment {
  std::string name;     // "accel_x_m_per_s2", with the number of the record where there are several
  std::size_t first{};  // its first sample in the response
  double scale{1.0};    // response = scale · what the channel measured
};

/// Time and shaft angle that the channels of one record share.
struct VibrationRun {
  std::vector<double> time_s;           // from 0
  std::vector<double> angle_rad;        // of the input shaft, from 0; empty where no speed is known
  std::vector<double> speed_rad_per_s;  // one a sample
  std::vector<double> time_2pi;         // 2π · time: a line of so many Hz turns by it
  std::vector<VibrationSegment> channels;
  double period_s{};  // median distance of samples
  double mean_speed_rad_per_s{};
  double speed_spread{};          // (largest − smallest) / mean
  double turns{};                 // of the input shaft
  Eigen::MatrixXd nominal;        // constant, and cos, sin at 1 and 2 per turn
  Eigen::MatrixXd decorrelation;  // DecorrelationOf its channels

  std::size_t size() const { return time_s.size(); }
  double span_s() const { return time_s.back(); }
  bool FollowsAGap(std::size_t i) const { return i > 0 && time_s[i] - time_s[i - 1] > 1.6 * period_s; }
};

/// All records, ready to be fitted. The response is the channels one after the other, each scaled so that all
/// have the same noise: the scales' harmonic mean square is one, so that the response of a single channel is
/// what it measured.
struct VibrationSamples {
  std::vector<double> measured;
  std::vector<std::size_t> segments;  // starts of channels, and of what comes after a gap in time
  std::vector<std::size_t> channel_starts;
  std::vector<VibrationRun> runs;
  double ratio{80.0};
  double noise_floor{};
  double order_uncertainty{};  // relative standard error of the angle's scale, where it was estimated
  std::vector<std::string> warnings;

  bool angle_known() const { return !runs.front().angle_rad.empty(); }
  std::size_t channels() const;
  /// Half the sampling rate, in Hz and in orders per input turn; of the record where it is least.
  double highest_Hz() const;
  double highest_order() const;
  double shortest_turns() const;
};

/// Share of its speed that a drive wanders by unseen, beside a speed that is stated or measured: it moves all
/// orders together.
inline constexpr double kUnseenWander = 1e-5;

/// Checks the records, finds angle and scales.
/// @throws std::invalid_argument in words for a technician.
VibrationSamples PrepareVibration(std::span<const VibrationData> records);

/// Constant and the shaft's first two harmonics; the constant alone without an angle.
void FillNominal(VibrationRun& run);

}  // namespace strainwave::analysis::diagnosis
