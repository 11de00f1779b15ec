// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/hysteresis/jumps.h"

#include <algorithm>
#include <utility>

namespace strainwave::analysis::diagnosis {

RunningSums RunningSumsOf(std::span<const double> weights, std::span<const double> residual) {
  RunningSums sums{std::vector<double>(weights.size() + 1, 0.0),
                   std::vector<double>(weights.size() + 1, 0.0)};
  for (std::size_t i = 0; i < weights.size(); ++i) {
    sums.sum[i + 1] = sums.sum[i] + weights[i] * residual[i];
    sums.weight[i + 1] = sums.weight[i] + weights[i];
  }
  return sums;
}

std::vector<std::size_t> BestJumps(std::span<const double> weights, std::span<const double> residual,
                                   std::size_t count) {
  const std::size_t n = weights.size();
  const RunningSums sums = RunningSumsOf(weights, residual);
  const std::vector<double>& sum = sums.sum;
  const std::vector<double>& weight = sums.weight;
  std::vector<std::pair<double, std::size_t>> jumps;
  for (const std::size_t reach : {n / 100, n / 25, n / 8}) {
    for (std::size_t i = reach; reach > 2 && i + reach < n; ++i) {
      const double before = weight[i] - weight[i - reach];
      const double after = weight[i + reach] - weight[i];
      if (!(before > 0.0) || !(after > 0.0)) continue;
      const double step = (sum[i + reach] - sum[i]) / after - (sum[i] - sum[i - reach]) / before;
      jumps.emplace_back(step * step / (1.0 / before + 1.0 / after), i);
    }
  }
  std::sort(jumps.rbegin(), jumps.rend());
  std::vector<std::size_t> best;
  for (const auto& [drop, sample] : jumps) {
    const bool close = std::any_of(best.begin(), best.end(), [&, at = sample](std::size_t other) {
      return (at > other ? at - other : other - at) < n / 50;
    });
    if (!close) best.push_back(sample);
    if (best.size() == count) break;
  }
  return best;
}

}  // namespace strainwave::analysis::diagnosis
