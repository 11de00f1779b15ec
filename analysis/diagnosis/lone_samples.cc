// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/lone_samples.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "analysis/noise_level.h"

namespace strainwave::analysis::diagnosis {
namespace {

// What every sample stands off the cubic through two samples on either side; 0 for the two at each end.
std::vector<double> OffTheCubic(std::span<const double> signal) {
  std::vector<double> off(signal.size(), 0.0);
  for (std::size_t i = 2; i + 2 < signal.size(); ++i) {
    off[i] = signal[i] - (4.0 * (signal[i - 1] + signal[i + 1]) - signal[i - 2] - signal[i + 2]) / 6.0;
  }
  return off;
}

// Samples that stand off the medians before and after them to the same side, while those next to them do not.
std::vector<std::size_t> OffTheMedians(std::span<const double> signal, std::span<const double> off_cubic,
                                       double cubic_deviation, double resolution) {
  constexpr std::size_t kReach = 4;
  constexpr double kStandsOff = 5.5;    // standard deviations; one clean sample in 26 million
  constexpr double kOffTheCubic = 4.0;  // standard deviations, larger ones
  constexpr double kNextTo = 0.35;      // of the spike
  constexpr double kFlicker = 2.0;      // steps of the resolution
  const std::size_t n = signal.size();
  std::vector<double> off(n, 0.0);     // from the nearer of the medians
  std::vector<double> middle(n, 0.0);  // from the mean of both
  for (std::size_t i = 1; i + 1 < n; ++i) {
    const auto at = signal.begin() + static_cast<std::ptrdiff_t>(i);
    const double before = Median({at - static_cast<std::ptrdiff_t>(std::min(kReach, i)), at});
    const double after = Median({at + 1, at + 1 + static_cast<std::ptrdiff_t>(std::min(kReach, n - 1 - i))});
    middle[i] = *at - 0.5 * (before + after);
    // At the foot of a step a sample stands off one side only.
    const double rise = *at - before;
    const double fall = *at - after;
    if (rise * fall > 0.0) off[i] = std::abs(rise) < std::abs(fall) ? rise : fall;
  }
  const double limit = kStandsOff * RobustStandardDeviation(middle) + kFlicker * resolution;
  std::vector<std::size_t> found;
  for (std::size_t i = 1; i + 1 < n; ++i) {
    const double size = std::abs(off[i]);
    if (!(size > limit && std::abs(off[i - 1]) < kNextTo * size && std::abs(off[i + 1]) < kNextTo * size))
      continue;
    // Where a slowing torque turns over with the friction there is such a corner, too, which a cubic follows.
    const bool has_cubic = i >= 2 && i + 2 < n;
    if (!has_cubic || std::abs(off_cubic[i]) > kOffTheCubic * cubic_deviation) found.push_back(i);
  }
  return found;
}

// Samples that stand off the cubic while those next to them do not once the sample is bridged: in a signal
// that changes by many times its noise from sample to sample, where all else hides a spike.
std::vector<std::size_t> OffTheCubicAlone(std::span<const double> signal, std::span<const double> off_cubic,
                                          double cubic_deviation, double resolution) {
  constexpr double kStandsOff = 8.0;    // standard deviations
  constexpr double kOut = 0.5;          // of the spike
  constexpr double kNextTo = 0.12;      // of the spike; a step or a corner leaves 1/3 or 1/6 of itself
  constexpr double kNextToNoise = 2.5;  // standard deviations
  const double deviation = cubic_deviation + resolution;
  std::vector<std::size_t> found;
  for (std::size_t i = 3; i + 3 < signal.size(); ++i) {
    const double size = std::abs(off_cubic[i]);
    if (!(size > kStandsOff * deviation)) continue;
    // Out to the same side of both: within a step it is not.
    const double sign = off_cubic[i] > 0.0 ? 1.0 : -1.0;
    if (sign * (signal[i] - signal[i - 1]) < kOut * size || sign * (signal[i] - signal[i + 1]) < kOut * size)
      continue;
    // What a neighbour stands off has 4/6 of the spike in it.
    const double bridged = off_cubic[i] * 4.0 / 6.0;
    const double left = std::max(std::abs(off_cubic[i - 1] + bridged), std::abs(off_cubic[i + 1] + bridged));
    if (left < std::max(kNextTo * size, kNextToNoise * deviation)) found.push_back(i);
  }
  return found;
}

}  // namespace

std::vector<std::size_t> FindLoneSamples(std::span<const double> signal, double resolution) {
  constexpr std::size_t kFewest = 16;
  if (signal.size() < kFewest) return {};
  const std::vector<double> off_cubic = OffTheCubic(signal);
  const double deviation = RobustStandardDeviation(off_cubic);
  std::vector<std::size_t> lone;
  std::ranges::set_union(OffTheMedians(signal, off_cubic, deviation, resolution),
                         OffTheCubicAlone(signal, off_cubic, deviation, resolution),
                         std::back_inserter(lone));
  return lone;
}

}  // namespace strainwave::analysis::diagnosis
