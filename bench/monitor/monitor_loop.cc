// SPDX-License-Identifier: Apache-2.0
#include "bench/monitor/monitor_loop.h"

#include <chrono>
#include <utility>
#include <vector>

namespace strainwave::bench {
namespace {

constexpr std::chrono::milliseconds kPatience{50};  // in which a stop and staleness are seen

}  // namespace

void RunMonitor(VibrationSource& source, WindowCutter& cutter, WindowJudge& judge, Board& board,
                const MonitorListener& listener, const std::atomic<bool>& stop) {
  bool stale = false;
  const auto judge_all = [&](const std::vector<VibrationWindow>& windows) {
    for (const VibrationWindow& window : windows) {
      const MonitorResult result = judge.Judge(window);
      board.Show(result);
      listener.on_result(result);
      stale = false;
    }
  };
  VibrationChunk chunk;
  while (!stop) {
    const VibrationSource::Got got = source.Next(kPatience, chunk);
    if (got == VibrationSource::Got::kChunk) judge_all(cutter.Add(chunk));
    const bool is_stale =
        StatusOf(board.State(), board.frame(), board.NowMilliseconds()) == ValueStatus::kStale;
    if (is_stale && !std::exchange(stale, true)) listener.on_stale();
    if (got == VibrationSource::Got::kEnd) break;
  }
  if (!stop) judge_all(cutter.Finish());
}

}  // namespace strainwave::bench
