// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/lone_samples.h"

#include <algorithm>
#include <cmath>

#include "analysis/noise_level.h"

namespace strainwave::analysis::diagnosis {

std::vector<std::size_t> FindLoneSamples(std::span<const double> signal, double resolution) {
  constexpr std::size_t kReach = 4;
  constexpr double kStandsOff = 5.5;  // standard deviations; one clean sample in 26 million
  constexpr double kNextTo = 0.35;    // of the spike
  constexpr double kFlicker = 2.0;    // steps of the resolution
  constexpr double kMayMeet = 0.02;   // pairs that chance makes
  constexpr std::size_t kMostSideBySide = 2;
  constexpr std::size_t kRinging = 12;
  std::vector<std::size_t> lone;
  const std::size_t n = signal.size();
  if (n < 4 * kReach) return lone;
  std::vector<double> off(n, 0.0);     // from the medians before and after, the nearer of them
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
  for (std::size_t i = 1; i + 1 < n; ++i) {
    const double size = std::abs(off[i]);
    if (size > limit && std::abs(off[i - 1]) < kNextTo * size && std::abs(off[i + 1]) < kNextTo * size) {
      lone.push_back(i);
    }
  }
  // Where there are so many that two may stand side by side by chance, these are as little physical.
  const auto count = static_cast<double>(lone.size());
  if (count * count < kMayMeet * static_cast<double>(n)) return lone;
  const auto stands_off = [&](std::size_t i) { return std::abs(off[i]) > limit; };
  for (std::size_t i = 1; i + 2 < n;) {
    std::size_t end = i;
    while (end + 1 < n && stands_off(end)) ++end;
    if (end > i && end - i <= kMostSideBySide) {
      // What rings stands off again a few samples on.
      bool company = false;
      for (std::size_t k = i > kRinging ? i - kRinging : 0; k < std::min(n, end + kRinging); ++k) {
        company = company || ((k < i || k >= end) && stands_off(k));
      }
      if (!company) {
        for (std::size_t k = i; k < end; ++k) lone.push_back(k);
      }
    }
    i = end + 1;
  }
  std::ranges::sort(lone);
  lone.erase(std::unique(lone.begin(), lone.end()), lone.end());
  return lone;
}

}  // namespace strainwave::analysis::diagnosis
