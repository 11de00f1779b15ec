// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>

namespace strainwave::analysis {

/// Calls task(0) … task(count − 1), in any order and on any threads, and comes back when all are done.
/// Threads are the caller's matter; `InTurn` uses none.
using ParallelFor = std::function<void(std::size_t count, const std::function<void(std::size_t)>& task)>;

inline void InTurn(std::size_t count, const std::function<void(std::size_t)>& task) {
  for (std::size_t i = 0; i < count; ++i) task(i);
}

}  // namespace strainwave::analysis
