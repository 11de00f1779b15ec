// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

namespace strainwave::bench {

/// The numbers go to PLCs and never change their meaning.
enum class AlarmLevel { kOk = 0, kWarning = 1, kAlarm = 2 };

/// "ok", "warning", "alarm".
std::string_view NameOf(AlarmLevel level);

/// When a value is too high or too low, in its unit.
struct AlarmLimits {
  std::optional<double> warning_above, warning_below, alarm_above, alarm_below;
  double hysteresis{};     // ≥ 0: so far back within a limit the value must come before the level falls
  std::int64_t hold_ms{};  // ≥ 0: so long a value must lie on the other side before the level changes
};

/// One level on or off, and since when the values have asked for the other.
struct AlarmLatch {
  bool active{};
  std::optional<std::int64_t> changing_since_ms;
};

/// Warning and alarm have a latch each, so that values that jump between the two still raise the lower one.
struct AlarmState {
  AlarmLatch warning, alarm;

  AlarmLevel level() const {
    return alarm.active ? AlarmLevel::kAlarm : warning.active ? AlarmLevel::kWarning : AlarmLevel::kOk;
  }
};

/// The state after a value.
/// @param value  finite.
/// @param now_ms  of the value; a time before the last one counts as no time passed.
AlarmState Next(const AlarmState& state, const AlarmLimits& limits, double value, std::int64_t now_ms);

}  // namespace strainwave::bench
