// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/lone_samples.h"

#include <algorithm>
#include <cmath>

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

// What every sample stands off the medians before and after it, to the same side of both; 0 within steps.
struct OffTheMedians {
  std::vector<double> off;  // from the nearer of them
  double limit{};           // beyond it a sample stands off
};
OffTheMedians StandOff(std::span<const double> signal, double resolution) {
  constexpr std::size_t kReach = 4;
  constexpr double kStandsOff_sd = 5.5;  // standard deviations; one clean sample in 26 million
  constexpr double kFlicker = 2.0;       // steps of the resolution
  const std::size_t n = signal.size();
  OffTheMedians medians{.off = std::vector<double>(n, 0.0)};
  std::vector<double> middle(n, 0.0);  // from the mean of both
  for (std::size_t i = 1; i + 1 < n; ++i) {
    const auto at = signal.begin() + static_cast<std::ptrdiff_t>(i);
    const double before = Median({at - static_cast<std::ptrdiff_t>(std::min(kReach, i)), at});
    const double after = Median({at + 1, at + 1 + static_cast<std::ptrdiff_t>(std::min(kReach, n - 1 - i))});
    middle[i] = *at - 0.5 * (before + after);
    // At the foot of a step a sample stands off one side only.
    const double rise = *at - before;
    const double fall = *at - after;
    if (rise * fall > 0.0) medians.off[i] = std::abs(rise) < std::abs(fall) ? rise : fall;
  }
  medians.limit = kStandsOff_sd * RobustStandardDeviation(middle) + kFlicker * resolution;
  return medians;
}

// Samples that stand off the medians while those next to them do not.
std::vector<std::size_t> Alone(const OffTheMedians& medians, std::span<const double> off_cubic,
                               double cubic_deviation) {
  constexpr double kOffTheCubic = 4.0;  // standard deviations, larger ones
  constexpr double kNextTo = 0.35;      // of the spike
  const std::vector<double>& off = medians.off;
  std::vector<std::size_t> found;
  for (std::size_t i = 1; i + 1 < off.size(); ++i) {
    const double size = std::abs(off[i]);
    if (!(size > medians.limit) || !(std::max(std::abs(off[i - 1]), std::abs(off[i + 1])) < kNextTo * size))
      continue;
    // Where a slowing torque turns over with the friction there is such a corner, too, which a cubic follows.
    const bool has_cubic = i >= 2 && i + 2 < off.size();
    if (!has_cubic || std::abs(off_cubic[i]) > kOffTheCubic * cubic_deviation) found.push_back(i);
  }
  return found;
}

// Where there are so many alone that two may stand side by side by chance, these are as little physical. What
// rings stands off again a few samples on and is something.
std::vector<std::size_t> SideBySide(const OffTheMedians& medians, std::size_t alone) {
  constexpr double kMayMeet = 0.02;  // pairs that chance makes
  constexpr std::size_t kMostSideBySide = 2;
  constexpr std::size_t kRinging = 12;
  const std::size_t n = medians.off.size();
  const auto count = static_cast<double>(alone);
  if (count * count < kMayMeet * static_cast<double>(n)) return {};
  const auto stands_off = [&](std::size_t i) { return std::abs(medians.off[i]) > medians.limit; };
  std::vector<std::size_t> found;
  for (std::size_t i = 1; i + 2 < n;) {
    std::size_t end = i;
    while (end + 1 < n && stands_off(end)) ++end;
    if (end > i && end - i <= kMostSideBySide) {
      bool company = false;
      for (std::size_t k = i > kRinging ? i - kRinging : 0; k < std::min(n, end + kRinging); ++k)
        company = company || ((k < i || k >= end) && stands_off(k));
      for (std::size_t k = i; k < end && !company; ++k) found.push_back(k);
    }
    i = end + 1;
  }
  return found;
}

// Samples that stand off the cubic while those next to them do not once the sample is bridged: in a signal
// that changes by many times its noise from sample to sample, where all else hides a spike.
std::vector<std::size_t> OffTheCubicAlone(std::span<const double> signal, std::span<const double> off_cubic,
                                          double cubic_deviation, double resolution) {
  constexpr double kStandsOff_sd = 8.0;  // standard deviations
  constexpr double kOut = 0.5;           // of the spike
  constexpr double kNextTo = 0.12;       // of the spike; a step or a corner leaves 1/3 or 1/6 of itself
  constexpr double kNextToNoise = 2.5;   // standard deviations
  const double deviation = cubic_deviation + resolution;
  std::vector<std::size_t> found;
  for (std::size_t i = 3; i + 3 < signal.size(); ++i) {
    const double size = std::abs(off_cubic[i]);
    if (!(size > kStandsOff_sd * deviation)) continue;
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
  const OffTheMedians medians = StandOff(signal, resolution);
  std::vector<std::size_t> lone = Alone(medians, off_cubic, deviation);
  for (const auto& more :
       {SideBySide(medians, lone.size()), OffTheCubicAlone(signal, off_cubic, deviation, resolution)})
    lone.insert(lone.end(), more.begin(), more.end());
  std::ranges::sort(lone);
  lone.erase(std::unique(lone.begin(), lone.end()), lone.end());
  return lone;
}

}  // namespace strainwave::analysis::diagnosis
