// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace strainwave::bench {

enum class AlarmPriority { kLow, kMedium, kHigh };

/// "low", "medium", "high".
std::string_view Name(AlarmPriority priority);
std::optional<AlarmPriority> AlarmPriorityNamed(std::string_view name);

/// A kind of alarm: an interlock, or what else ends or holds up a run, by its code in the journal.
struct AlarmKind {
  std::string_view code;
  AlarmPriority priority;
  bool latching;  // stays open until a person confirms that the cause is mended
};

/// All there are. High: the specimen or the bench may be hurt. Medium: the run has ended, and nothing was
/// beyond a limit. Low: it ended as the schedule has it. A limit of the specimen latches.
inline constexpr std::array kAlarmKinds{
    AlarmKind{"output_torque_limit", AlarmPriority::kHigh, true},
    AlarmKind{"input_speed_limit", AlarmPriority::kHigh, true},
    AlarmKind{"gear_temperature_limit", AlarmPriority::kHigh, true},
    AlarmKind{"vibration_limit", AlarmPriority::kHigh, true},
    AlarmKind{"twist_limit", AlarmPriority::kHigh, true},
    AlarmKind{"stale_readings", AlarmPriority::kHigh, false},
    AlarmKind{"implausible_reading", AlarmPriority::kHigh, false},
    AlarmKind{"input_angle_apart", AlarmPriority::kHigh, false},
    AlarmKind{"drive_fault", AlarmPriority::kHigh, false},
    AlarmKind{"drive_not_ready", AlarmPriority::kMedium, false},
    AlarmKind{"drive_silent", AlarmPriority::kHigh, false},
    AlarmKind{"drive_dropped_out", AlarmPriority::kHigh, false},
    AlarmKind{"brake_engaged", AlarmPriority::kHigh, false},
    AlarmKind{"torque_away", AlarmPriority::kMedium, false},
    AlarmKind{"speed_away", AlarmPriority::kMedium, false},
    AlarmKind{"position_away", AlarmPriority::kMedium, false},
    AlarmKind{"torque_factor", AlarmPriority::kMedium, false},
    AlarmKind{"torque_of_check", AlarmPriority::kMedium, false},
    AlarmKind{"speed_factor", AlarmPriority::kMedium, false},
    AlarmKind{"phase_timeout", AlarmPriority::kMedium, false},
    AlarmKind{"torque_at_rest", AlarmPriority::kMedium, false},
    AlarmKind{"reference_check", AlarmPriority::kMedium, false},
    AlarmKind{"sensor_check", AlarmPriority::kMedium, false},
    AlarmKind{"log_full", AlarmPriority::kMedium, false},
    AlarmKind{"did_not_cool", AlarmPriority::kMedium, false},
    AlarmKind{"sensor_stayed_bad", AlarmPriority::kMedium, false},
    AlarmKind{"no_values", AlarmPriority::kMedium, false},
    AlarmKind{"disk_fills", AlarmPriority::kMedium, false},
    AlarmKind{"disk_full", AlarmPriority::kMedium, false},
    AlarmKind{"stop_criterion", AlarmPriority::kLow, false},
};

/// What a bench file says of one kind; what it leaves out is the kind's own.
struct AlarmRule {
  std::string code;
  std::optional<AlarmPriority> priority;
  std::optional<bool> latching;
  std::string guidance{};  // what to do, in the words of whoever knows the bench
};

/// The kind of that code; of one that this program does not know: medium, not latching.
AlarmKind KindOf(std::string_view code);
AlarmPriority PriorityOf(std::string_view code, std::span<const AlarmRule> rules);
bool IsLatching(std::string_view code, std::span<const AlarmRule> rules);
/// Empty where the bench file has none.
std::string GuidanceOf(std::string_view code, std::span<const AlarmRule> rules);

}  // namespace strainwave::bench
