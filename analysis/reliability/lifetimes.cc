// SPDX-License-Identifier: Apache-2.0
#include "analysis/reliability/lifetimes.h"

#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

namespace strainwave::analysis::reliability {

LifetimeCounts CountLifetimes(std::span<const Lifetime> lifetimes) {
  LifetimeCounts counts;
  for (const Lifetime& life : lifetimes) {
    counts.units += life.count;
    if (life.is_failure()) counts.failures += life.count;
  }
  return counts;
}

void RequireLifetimes(std::span<const Lifetime> lifetimes) {
  if (lifetimes.empty()) throw std::invalid_argument("lifetimes has 0 values (expected at least 1)");
  for (std::size_t i = 0; i < lifetimes.size(); ++i) {
    const Lifetime& life = lifetimes[i];
    const bool ends = life.upper > 0.0 && life.upper >= life.lower;
    const bool begins = std::isfinite(life.lower) && life.lower >= 0.0;
    if (!(ends && begins) || (life.lower == 0.0 && life.upper == kNever))
      throw std::invalid_argument(
          fmt::format("lifetimes[{}] from {} to {} is no life (expected times above zero in order)", i,
                      life.lower, life.upper));
    if (!(std::isfinite(life.count) && life.count > 0.0))
      throw std::invalid_argument(
          fmt::format("lifetimes[{}].count = {} is not a positive number", i, life.count));
  }
}

}  // namespace strainwave::analysis::reliability
