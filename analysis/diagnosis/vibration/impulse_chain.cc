// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/vibration/impulse_chain.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "analysis/units.h"

namespace strainwave::analysis::diagnosis {
namespace {

// Slips are a percent or two of the period; nothing is known of five times as much.
constexpr double kUsualSlip = 0.015;
constexpr double kLargestSlip = 0.1;

// Periods of an order from one impulse to the next, and how many of them there are: one at least.
double PeriodsOf(double angle_rad, double order) { return angle_rad * order / kTwoPi; }
double WholePeriods(double periods) { return std::max(1.0, std::round(periods)); }

// Numbers of impulses about an order, the first one's 0: those in a gap have theirs, too.
std::vector<double> NumbersOf(const std::vector<double>& angles_rad, double order) {
  std::vector<double> numbers{0.0};
  for (std::size_t j = 1; j < angles_rad.size(); ++j)
    numbers.push_back(numbers.back() + WholePeriods(PeriodsOf(angles_rad[j] - angles_rad[j - 1], order)));
  return numbers;
}

}  // namespace

std::vector<std::size_t> BestChain(const VibrationRun& run, double order, const std::vector<double>& score) {
  const std::size_t n = run.size();
  std::vector<double> best(score);
  std::vector<std::size_t> before(n, n);
  const auto apart_at = [&](std::size_t i) {
    return kTwoPi / (order * std::max(run.speed_rad_per_s[i], 1e-9) * run.period_s);
  };
  std::size_t segment = 0;  // where the last gap ends
  for (std::size_t i = 0; i < n; ++i) {
    if (run.FollowsAGap(i)) segment = i;
    const double apart = apart_at(i);
    auto nearest = static_cast<std::size_t>(std::max(1.0, (1.0 - kLargestSlip) * apart));
    auto farthest = static_cast<std::size_t>((1.0 + kLargestSlip) * apart) + 1;
    const bool over_gap = segment > 0 && i < segment + farthest;
    if (over_gap) {
      nearest = i - segment + 1;
      farthest += nearest;
    }
    if (i < farthest) continue;
    double most = -1e300;
    for (std::size_t back = nearest; back <= farthest; ++back) {
      double off = static_cast<double>(back) / apart - 1.0;
      if (over_gap) {
        const double periods = PeriodsOf(run.angle_rad[i] - run.angle_rad[i - back], order);
        const double whole = WholePeriods(periods);
        off = (periods - whole) / std::sqrt(whole);
      }
      const double slip = off / kUsualSlip;
      const double chain = best[i - back] - 0.5 * slip * slip;
      if (chain > most) {
        most = chain;
        before[i] = i - back;
      }
    }
    best[i] += most;
  }
  const auto last = static_cast<std::ptrdiff_t>(std::min<double>(static_cast<double>(n), apart_at(n - 1)));
  auto at = static_cast<std::size_t>(std::max_element(best.end() - last, best.end()) - best.begin());
  std::vector<std::size_t> chain;
  for (; at < n; at = before[at]) chain.push_back(at);
  std::ranges::reverse(chain);
  return chain;
}

bool TakeImpulses(const VibrationRun& run, const std::vector<double>& angles_rad, VibrationTerm& term) {
  const std::size_t count = angles_rad.size();
  if (count < 8) return false;
  const std::vector<double> numbers = NumbersOf(angles_rad, term.nonlinear_parameters[0]);
  const double middle = std::reduce(numbers.begin(), numbers.end()) / static_cast<double>(count);
  double squares = 0.0;
  double both = 0.0;
  double mean = 0.0;
  for (std::size_t j = 0; j < count; ++j) {
    const double number = numbers[j] - middle;
    squares += number * number;
    both += number * angles_rad[j];
    mean += angles_rad[j] / static_cast<double>(count);
  }
  const double order = kTwoPi * squares / both;
  const double at_middle = (mean - 0.5 * run.angle_rad.back()) * order / kTwoPi;
  const double first = std::round(at_middle - middle);
  const double phase = at_middle - middle - first;
  const double last = first + numbers.back();
  const auto half = static_cast<std::size_t>(std::max(std::abs(first), std::abs(last) + 1.0)) + 1;
  term.slips.assign(2 * half + 1, 0.0);
  // Where no impulse was observable the last slip goes on.
  std::size_t j = 0;
  for (std::size_t s = 0; s < term.slips.size(); ++s) {
    const double number = static_cast<double>(s) - static_cast<double>(half) - first;
    while (j + 1 < count && numbers[j + 1] <= number) ++j;
    const double at = (angles_rad[j] - 0.5 * run.angle_rad.back()) * order / kTwoPi;
    term.slips[s] = at - (first + numbers[j] + phase);
  }
  term.nonlinear_parameters[0] = order;
  term.nonlinear_parameters[3 + 2 * term.lines.size()] = phase;
  return true;
}

}  // namespace strainwave::analysis::diagnosis
