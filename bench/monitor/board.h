// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <mutex>
#include <utility>

#include "bench/monitor/monitor_result.h"

namespace strainwave::bench {

/// The newest state of a monitor, for threads that show it.
class Board {
 public:
  /// @param now_ms  time of the stream, from any thread: values grow old also when the monitor itself hangs.
  Board(MonitorFrame frame, std::function<std::int64_t()> now_ms)
      : frame_(std::move(frame)), now_ms_(std::move(now_ms)) {}

  const MonitorFrame& frame() const { return frame_; }
  std::int64_t NowMilliseconds() const { return now_ms_(); }

  MonitorState State() const {
    const std::scoped_lock lock(mutex_);
    return state_;
  }

  /// Shows a result and counts it.
  void Show(const MonitorResult& result) {
    const std::scoped_lock lock(mutex_);
    state_.last = result;
    ++(result.fault              ? state_.bad_windows
       : result.outside_training ? state_.outside_windows
                                 : state_.good_windows);
  }
  void Show(const LinkState& link) {
    const std::scoped_lock lock(mutex_);
    state_.link = link;
  }

 private:
  MonitorFrame frame_;
  std::function<std::int64_t()> now_ms_;
  mutable std::mutex mutex_;
  MonitorState state_;
};

}  // namespace strainwave::bench
