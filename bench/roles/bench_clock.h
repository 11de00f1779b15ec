// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>

namespace strainwave::bench {

/// The monotonic clock that the control loop keeps its period on. It starts at zero with the process and is
/// never set; wall-clock time is for people and stands beside it in the journal.
class BenchClock {
 public:
  BenchClock() = default;
  BenchClock(const BenchClock&) = delete;
  BenchClock& operator=(const BenchClock&) = delete;
  virtual ~BenchClock() = default;

  virtual std::chrono::nanoseconds Now() const noexcept = 0;
  /// Returns when `time` has come; at once when it has passed, which counts as an overrun.
  virtual void SleepUntil(std::chrono::nanoseconds time) noexcept = 0;
  virtual std::uint64_t Overruns() const noexcept = 0;
};

}  // namespace strainwave::bench
