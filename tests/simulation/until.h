// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <thread>

namespace strainwave::bench {

/// Waits for what other threads bring about; the test's own time-out ends it where that never comes.
template <typename Condition>
void Until(Condition condition) {
  while (!condition()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
}

}  // namespace strainwave::bench
