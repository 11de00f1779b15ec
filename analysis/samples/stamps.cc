// SPDX-License-Identifier: Apache-2.0
#include "analysis/samples/stamps.h"

#include <algorithm>
#include <cmath>

#include "analysis/noise_level.h"

namespace strainwave::analysis::samples {
namespace {

constexpr double kTicksOff = 1.3;  // by which stamps of a slow clock may be off even ones, to either side

std::vector<double> StepsOf(std::span<const double> time_s) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < time_s.size(); ++i) steps.push_back(time_s[i] - time_s[i - 1]);
  return steps;
}

}  // namespace

bool EvenWithinTicks(std::vector<double>& time_s) {
  double tick_s = time_s.back() - time_s.front();
  for (std::size_t i = 1; i < time_s.size(); ++i) {
    if (time_s[i] > time_s[i - 1]) tick_s = std::min(tick_s, time_s[i] - time_s[i - 1]);
  }
  for (std::size_t first = 0; first < time_s.size();) {
    std::size_t last = first + 1;
    while (last < time_s.size() && time_s[last] - time_s[last - 1] <= kGap * tick_s) ++last;
    const auto count = static_cast<double>(last - first);
    // By least squares: the ends are within a tick only.
    double mean_s = 0.0;
    for (std::size_t i = first; i < last; ++i) mean_s += time_s[i] / count;
    double along = 0.0;
    double squares = 0.0;
    for (std::size_t i = first; i < last; ++i) {
      const double offset = static_cast<double>(i - first) - 0.5 * (count - 1.0);
      along += offset * (time_s[i] - mean_s);
      squares += offset * offset;
    }
    const double step_s = squares > 0.0 ? along / squares : 0.0;
    double early_s = 0.0;
    double late_s = 0.0;
    for (std::size_t i = first; i < last; ++i) {
      const double even_s = mean_s + step_s * (static_cast<double>(i - first) - 0.5 * (count - 1.0));
      early_s = std::min(early_s, even_s - time_s[i]);
      late_s = std::max(late_s, even_s - time_s[i]);
      time_s[i] = even_s;
    }
    if (late_s - early_s > kTicksOff * tick_s) return false;
    first = last;
  }
  return true;
}

std::size_t RepeatedStamps(std::span<const double> time_s) {
  std::size_t repeated = 0;
  for (std::size_t i = 1; i < time_s.size(); ++i) repeated += time_s[i] > time_s[i - 1] ? 0 : 1;
  return repeated;
}

double StampJitter(std::span<const double> time_s) {
  std::vector<double> steps = StepsOf(time_s);
  const double step_s = Median(steps);
  if (!(step_s > 0.0)) return 1.0;
  for (double& step : steps) step = std::abs(step / step_s - 1.0);
  return Median(std::move(steps));
}

StampRates RatesOf(std::span<const double> time_s) {
  if (time_s.size() < 2 || !(time_s.back() > time_s.front())) return {};
  const double step_s = Median(StepsOf(time_s));
  return {step_s > 0.0 ? 1.0 / step_s : 0.0,
          static_cast<double>(time_s.size() - 1) / (time_s.back() - time_s.front())};
}

}  // namespace strainwave::analysis::samples
