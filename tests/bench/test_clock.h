// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>

#include "bench/roles/bench_clock.h"

namespace strainwave::bench {

/// Time as the test says.
class TestClock final : public BenchClock {
 public:
  std::chrono::nanoseconds Now() const noexcept override { return now; }
  void SleepUntil(std::chrono::nanoseconds time) noexcept override { now = time; }
  std::uint64_t Overruns() const noexcept override { return 0; }

  std::chrono::nanoseconds now{};
};

}  // namespace strainwave::bench
