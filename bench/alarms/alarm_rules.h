// SPDX-License-Identifier: Apache-2.0
#pragma once

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
  bool latching;                // stays open until a person confirms that the cause is mended
  std::string_view guidance{};  // what to look at first, on any bench
};

/// All there are. High: the specimen or the bench may be hurt. Medium: the run has ended, and nothing was
/// beyond a limit. Low: it ended as the schedule has it. A limit of the specimen latches.
extern const std::span<const AlarmKind> kAlarmKinds;

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
/// The bench file's; where that has none, the kind's own.
std::string GuidanceOf(std::string_view code, std::span<const AlarmRule> rules);

}  // namespace strainwave::bench
