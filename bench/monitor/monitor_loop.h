// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <functional>

#include "bench/monitor/board.h"
#include "bench/monitor/monitor_result.h"
#include "bench/monitor/window.h"
#include "bench/monitor/window_judge.h"
#include "bench/roles/vibration_source.h"

namespace strainwave::bench {

/// Told by the loop, from its thread; must not wait.
struct MonitorListener {
  std::function<void(const MonitorResult&)> on_result;  // the board shows it already
  std::function<void()> on_stale;                       // once, when the newest values have grown too old
};

/// Takes vibration from the source until it ends or `stop` is set: windows, results, board, listener.
void RunMonitor(VibrationSource& source, WindowCutter& cutter, WindowJudge& judge, Board& board,
                const MonitorListener& listener, const std::atomic<bool>& stop);

}  // namespace strainwave::bench
