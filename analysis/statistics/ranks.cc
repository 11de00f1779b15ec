// SPDX-License-Identifier: Apache-2.0
#include "analysis/statistics/ranks.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "analysis/arguments.h"

namespace strainwave::analysis::statistics {

std::vector<double> MidRanks(std::span<const double> values) {
  std::vector<std::size_t> order(values.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::sort(order, {}, [values](std::size_t i) { return values[i]; });
  std::vector<double> ranks(values.size());
  for (std::size_t first = 0; first < order.size();) {
    std::size_t end = first + 1;
    while (end < order.size() && values[order[end]] == values[order[first]]) ++end;
    const double rank = 0.5 * static_cast<double>(first + 1 + end);
    for (std::size_t i = first; i < end; ++i) ranks[order[i]] = rank;
    first = end;
  }
  return ranks;
}

double PearsonCorrelation(std::span<const double> x, std::span<const double> y) {
  RequireSameLength("x", x, "y", y);
  if (x.size() < 2) return 0.0;
  const auto n = static_cast<double>(x.size());
  const double mean_x = std::accumulate(x.begin(), x.end(), 0.0) / n;
  const double mean_y = std::accumulate(y.begin(), y.end(), 0.0) / n;
  double xx = 0.0;
  double yy = 0.0;
  double xy = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double dx = x[i] - mean_x;
    const double dy = y[i] - mean_y;
    xx += dx * dx;
    yy += dy * dy;
    xy += dx * dy;
  }
  // Of a constant, only the rounding of its mean is left.
  constexpr double kRounding = 1e-14;
  if (!(xx > n * std::pow(kRounding * mean_x, 2)) || !(yy > n * std::pow(kRounding * mean_y, 2))) return 0.0;
  return std::clamp(xy / std::sqrt(xx * yy), -1.0, 1.0);
}

double SpearmanCorrelation(std::span<const double> x, std::span<const double> y) {
  RequireSameLength("x", x, "y", y);
  return PearsonCorrelation(MidRanks(x), MidRanks(y));
}

}  // namespace strainwave::analysis::statistics
