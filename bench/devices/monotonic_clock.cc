// SPDX-License-Identifier: Apache-2.0
#include "bench/devices/monotonic_clock.h"

#include <cerrno>
#include <ctime>

namespace strainwave::bench {
namespace {

constexpr std::int64_t kNanosecondsPerSecond = 1'000'000'000;

std::chrono::nanoseconds KernelNow() noexcept {
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  return std::chrono::nanoseconds(now.tv_sec * kNanosecondsPerSecond + now.tv_nsec);
}

}  // namespace

MonotonicClock::MonotonicClock() : start_(KernelNow()) {}

std::chrono::nanoseconds MonotonicClock::Now() const noexcept { return KernelNow() - start_; }

void MonotonicClock::SleepUntil(std::chrono::nanoseconds time) noexcept {
  const std::int64_t until = (start_ + time).count();
  if (KernelNow().count() >= until) {
    overruns_.fetch_add(1, std::memory_order_relaxed);
    return;
  }
  const timespec target{until / kNanosecondsPerSecond, until % kNanosecondsPerSecond};
  while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &target, nullptr) == EINTR) {
  }
}

}  // namespace strainwave::bench
