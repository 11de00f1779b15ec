// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <thread>

#include "bench/roles/bench_clock.h"

namespace strainwave::bench {

/// The clock of a real bench, since the test began.
class SteadyBenchClock final : public BenchClock {
 public:
  std::chrono::nanoseconds Now() const noexcept override { return std::chrono::steady_clock::now() - start_; }
  void SleepUntil(std::chrono::nanoseconds time) noexcept override {
    std::this_thread::sleep_until(start_ + time);
  }
  std::uint64_t Overruns() const noexcept override { return 0; }

 private:
  std::chrono::steady_clock::time_point start_{std::chrono::steady_clock::now()};
};

/// Waits for an event, and never for a time.
bool Until(auto&& condition) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(30);
  while (!condition()) {
    if (std::chrono::steady_clock::now() > end) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return true;
}

}  // namespace strainwave::bench
