// SPDX-License-Identifier: Apache-2.0
#include "analysis/isotonic.h"

namespace strainwave::analysis {

std::vector<Pool> PoolAdjacentViolators(std::span<const double> values, std::span<const double> weights,
                                        bool rising) {
  std::vector<Pool> pools;
  pools.reserve(values.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double weight = weights.empty() ? 1.0 : weights[i];
    pools.push_back({weight * values[i], weight, 1});
    while (pools.size() > 1) {
      const Pool& last = pools.back();
      const Pool& previous = pools[pools.size() - 2];
      const bool in_order = rising ? previous.Mean() <= last.Mean() : previous.Mean() >= last.Mean();
      if (in_order) break;
      const Pool merged{previous.sum + last.sum, previous.weight + last.weight, previous.count + last.count};
      pools.pop_back();
      pools.back() = merged;
    }
  }
  return pools;
}

}  // namespace strainwave::analysis
