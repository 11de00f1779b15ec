// SPDX-License-Identifier: Apache-2.0
#include "bench/monitor/alarm.h"

#include <algorithm>

namespace strainwave::bench {
namespace {

AlarmLatch Next(AlarmLatch latch, std::optional<double> above, std::optional<double> below,
                const AlarmLimits& limits, double value, std::int64_t now_ms) {
  const double margin = latch.active ? limits.hysteresis : 0.0;
  const bool beyond = (above && value > *above - margin) || (below && value < *below + margin);
  if (beyond == latch.active) return {latch.active, std::nullopt};
  const std::int64_t since_ms = std::min(latch.changing_since_ms.value_or(now_ms), now_ms);
  if (now_ms - since_ms >= limits.hold_ms) return {beyond, std::nullopt};
  return {latch.active, since_ms};
}

}  // namespace

std::string_view NameOf(AlarmLevel level) {
  switch (level) {
    case AlarmLevel::kOk:
      return "ok";
    case AlarmLevel::kWarning:
      return "warning";
    case AlarmLevel::kAlarm:
      return "alarm";
  }
  return "alarm";
}

AlarmState Next(const AlarmState& state, const AlarmLimits& limits, double value, std::int64_t now_ms) {
  return {Next(state.warning, limits.warning_above, limits.warning_below, limits, value, now_ms),
          Next(state.alarm, limits.alarm_above, limits.alarm_below, limits, value, now_ms)};
}

}  // namespace strainwave::bench
