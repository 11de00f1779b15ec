// SPDX-License-Identifier: Apache-2.0
#include "bench/monitor/monitor_result.h"

#include <algorithm>

namespace strainwave::bench {

std::size_t LikeliestOf(const std::vector<MonitoredOutput>& outputs) {
  return static_cast<std::size_t>(std::ranges::max_element(outputs, {}, &MonitoredOutput::value) -
                                  outputs.begin());
}

std::string_view NameOf(ValueStatus status) {
  switch (status) {
    case ValueStatus::kNone:
      return "none";
    case ValueStatus::kGood:
      return "good";
    case ValueStatus::kBad:
      return "bad";
    case ValueStatus::kStale:
      return "stale";
    case ValueStatus::kOutsideTraining:
      return "outside_training";
  }
  return "bad";
}

ValueStatus StatusOf(const MonitorState& state, const MonitorFrame& frame, std::int64_t now_ms) {
  if (!state.last) return ValueStatus::kNone;
  if (now_ms - state.last->end_ms > frame.stale_after_ms) return ValueStatus::kStale;
  if (state.last->fault) return ValueStatus::kBad;
  return state.last->outside_training ? ValueStatus::kOutsideTraining : ValueStatus::kGood;
}

}  // namespace strainwave::bench
