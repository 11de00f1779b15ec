// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <limits>

namespace strainwave::bench {

/// A hand that must say again and again that it is there. From any thread.
class DeadMan {
 public:
  /// @param holds_for  how long one word of the hand is good for.
  explicit DeadMan(std::chrono::nanoseconds holds_for) : holds_for_(holds_for.count()) {}

  void Hold(std::chrono::nanoseconds now) noexcept { held_until_ = now.count() + holds_for_; }
  void Release() noexcept { held_until_ = kNever; }
  bool IsHeld(std::chrono::nanoseconds now) const noexcept { return now.count() < held_until_; }

 private:
  static constexpr std::int64_t kNever = std::numeric_limits<std::int64_t>::min();

  std::int64_t holds_for_;
  std::atomic<std::int64_t> held_until_{kNever};
};

}  // namespace strainwave::bench
