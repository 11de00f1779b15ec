// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <thread>
#include <vector>

namespace strainwave::analysis {

/// One thread a task, in reverse, so that the order in which they end differs from that of InTurn.
inline void OnThreads(std::size_t count, const std::function<void(std::size_t)>& task) {
  std::vector<std::thread> threads;
  for (std::size_t i = count; i-- > 0;) threads.emplace_back([&task, i] { task(i); });
  for (std::thread& thread : threads) thread.join();
}

}  // namespace strainwave::analysis
