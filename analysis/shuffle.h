// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <random>
#include <utility>
#include <vector>

namespace strainwave::analysis {

/// Fisher and Yates with an engine whose bits the standard fixes: std::shuffle's draws differ from one
/// standard library to the next. The excess of the remainder is below 2⁻³².
template <typename Value>
void Shuffle(std::vector<Value>& values, std::mt19937_64& engine) {
  for (std::size_t left = values.size(); left > 1; --left)
    std::swap(values[left - 1], values[engine() % left]);
}

}  // namespace strainwave::analysis
