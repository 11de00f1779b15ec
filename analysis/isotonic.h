// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace strainwave::analysis {

/// Neighbouring values that isotonic regression makes one.
struct Pool {
  double sum{};     // of weight × value
  double weight{};  // of all
  std::size_t count{};

  double Mean() const { return sum / weight; }
};

/// The monotone values that are nearest to the given ones by least squares, as pools in their order (pool
/// adjacent violators).
///
/// @param weights  one a value, > 0; empty where all weigh the same.
/// Source: Ayer et al., Ann. Math. Stat. 26 (1955) 641.
std::vector<Pool> PoolAdjacentViolators(std::span<const double> values, std::span<const double> weights,
                                        bool rising);

}  // namespace strainwave::analysis
