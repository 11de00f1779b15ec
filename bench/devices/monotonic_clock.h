// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>

#include "bench/roles/bench_clock.h"

namespace strainwave::bench {

/// The kernel's monotonic clock, zero when it was made. Any thread may ask it; one thread keeps its period on
/// it.
class MonotonicClock final : public BenchClock {
 public:
  MonotonicClock();

  std::chrono::nanoseconds Now() const noexcept override;
  void SleepUntil(std::chrono::nanoseconds time) noexcept override;
  std::uint64_t Overruns() const noexcept override { return overruns_.load(std::memory_order_relaxed); }

  /// The time on this clock of an instant of CLOCK_MONOTONIC, as a kernel stamps it.
  std::chrono::nanoseconds FromKernel(std::chrono::nanoseconds monotonic) const noexcept {
    return monotonic - start_;
  }

 private:
  std::chrono::nanoseconds start_;
  std::atomic<std::uint64_t> overruns_{};
};

}  // namespace strainwave::bench
