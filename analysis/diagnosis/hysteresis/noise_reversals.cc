// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/hysteresis/noise_reversals.h"

#include <algorithm>
#include <cmath>

namespace strainwave::analysis::diagnosis {
namespace {

// Last sample of the hold in which a branch ends.
std::size_t EndOfHold(std::span<const double> values, double noise, const Branch& branch, std::size_t limit) {
  std::size_t last = branch.last;
  while (last + 1 < limit && std::abs(values[last + 1] - values[branch.last]) <= noise) ++last;
  return last;
}

struct Pool {
  double value;
  double weight;
  std::size_t count;
};

// Values that never go back, as near to the given ones as can be.
std::vector<Pool> PoolViolators(std::span<const double> values, std::span<const double> errors, double sign) {
  std::vector<Pool> pools;
  for (std::size_t i = 0; i < values.size(); ++i) {
    pools.push_back({values[i], 1.0 / (errors[i] * errors[i]), 1});
    while (pools.size() > 1 && sign * pools[pools.size() - 2].value > sign * pools.back().value) {
      const Pool last = pools.back();
      pools.pop_back();
      Pool& pool = pools.back();
      const double weight = pool.weight + last.weight;
      pool = {(pool.weight * pool.value + last.weight * last.value) / weight, weight,
              pool.count + last.count};
    }
  }
  return pools;
}

}  // namespace

std::vector<double> WithoutNoiseReversals(std::span<const double> values, std::span<const double> errors,
                                          double noise, std::span<const Branch> branches) {
  std::vector<double> result(values.begin(), values.end());
  std::size_t first = 0;
  for (std::size_t b = 0; b < branches.size() && first < values.size(); ++b) {
    const bool is_last = b + 1 == branches.size();
    const std::size_t end =
        is_last ? values.size() : EndOfHold(values, noise, branches[b], branches[b + 1].last) + 1;
    const std::size_t count = end - first;
    std::size_t at = first;
    for (const Pool& pool : PoolViolators(values.subspan(first, count), errors.subspan(first, count),
                                          branches[b].rising ? 1.0 : -1.0)) {
      bool by_noise = true;
      for (std::size_t i = at; i < at + pool.count; ++i)
        by_noise = by_noise && std::abs(values[i] - pool.value) <= noise;
      if (by_noise) std::fill_n(result.begin() + static_cast<std::ptrdiff_t>(at), pool.count, pool.value);
      at += pool.count;
    }
    first = end;
  }
  return result;
}

}  // namespace strainwave::analysis::diagnosis
