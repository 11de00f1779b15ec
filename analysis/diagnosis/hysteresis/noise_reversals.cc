// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/hysteresis/noise_reversals.h"

#include <algorithm>
#include <cmath>

#include "analysis/isotonic.h"

namespace strainwave::analysis::diagnosis {
namespace {

// Last sample of the hold in which a branch ends.
std::size_t EndOfHold(std::span<const double> values, double noise, const Branch& branch, std::size_t limit) {
  std::size_t last = branch.last;
  while (last + 1 < limit && std::abs(values[last + 1] - values[branch.last]) <= noise) ++last;
  return last;
}

}  // namespace

std::vector<double> WithoutNoiseReversals(std::span<const double> values, std::span<const double> errors,
                                          double noise, std::span<const Branch> branches) {
  std::vector<double> weights(errors.size());
  std::ranges::transform(errors, weights.begin(), [](double error) { return 1.0 / (error * error); });
  std::vector<double> result(values.begin(), values.end());
  std::size_t at = 0;
  for (std::size_t b = 0; b < branches.size() && at < values.size(); ++b) {
    const bool is_last = b + 1 == branches.size();
    const std::size_t end =
        is_last ? values.size() : EndOfHold(values, noise, branches[b], branches[b + 1].last) + 1;
    const std::size_t count = end - at;
    for (const Pool& pool : PoolAdjacentViolators(
             values.subspan(at, count), std::span(weights).subspan(at, count), branches[b].rising)) {
      const auto pooled = values.subspan(at, pool.count);
      const bool by_noise =
          std::ranges::all_of(pooled, [&](double value) { return std::abs(value - pool.Mean()) <= noise; });
      if (pool.count > 1 && by_noise)
        std::ranges::fill(std::span(result).subspan(at, pool.count), pool.Mean());
      at += pool.count;
    }
  }
  return result;
}

}  // namespace strainwave::analysis::diagnosis
