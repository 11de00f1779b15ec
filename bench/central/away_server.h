// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <chrono>
#include <optional>
#include <string>
#include <utility>

namespace strainwave::bench {

/// Whether a server that does not answer is asked again: one question at a time, after 1, 2, 4 ... 15 s. All
/// others are told at once what the last attempt has met. Not for several threads at a time.
class AwayServer {
 public:
  using Time = std::chrono::steady_clock::time_point;
  static constexpr std::chrono::seconds kLongestWait{15};

  /// @param first_wait  before the first further attempt.
  explicit AwayServer(std::chrono::milliseconds first_wait) : first_wait_(first_wait) {}

  /// Nothing: it may be asked. Else why not.
  std::optional<std::string> WhyNot(Time now) const {
    if (failures_ == 0 || (!is_asked_ && now >= next_)) return std::nullopt;
    return why_;
  }
  void Ask() { is_asked_ = true; }
  void Answered() {
    is_asked_ = false;
    failures_ = 0;
  }
  void Failed(std::string why, Time now) {
    is_asked_ = false;
    next_ = now + std::min<std::chrono::milliseconds>(
                      first_wait_ * (1 << std::min(failures_, 10)),
                      std::max<std::chrono::milliseconds>(kLongestWait, first_wait_));
    ++failures_;
    why_ = std::move(why);
  }
  /// The question under way has no answer for so long that others are no longer to wait behind it.
  void Overdue(std::string why) {
    if (!is_asked_) return;
    failures_ = std::max(failures_, 1);
    why_ = std::move(why);
  }

 private:
  std::chrono::milliseconds first_wait_;
  bool is_asked_{};
  int failures_{};
  Time next_{};
  std::string why_;
};

}  // namespace strainwave::bench
