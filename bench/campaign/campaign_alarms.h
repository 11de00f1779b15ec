// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "bench/alarms/alarm_list.h"
#include "bench/campaign/folder.h"
#include "bench/campaign/journal.h"
#include "bench/campaign/pause.h"

namespace strainwave::bench {

inline constexpr std::string_view kStopCriterionAlarm = "stop_criterion";

/// Of a list that was read: those whose shelf is over by now come off it, one of them maybe cleared. A clock
/// that is set back lengthens no shelf: within one boot of the machine the boot's clock counts, and where no
/// clock knows, the shelf is over.
void TakeOffShelves(std::vector<AlarmInstance>& instances, const Moment& now);

/// Those that are open, or all, as they are now.
struct AlarmList {
  std::vector<AlarmInstance> alarms;
  std::size_t raised_ever{};
};
AlarmList ReadAlarms(const Journal& journal, bool all, const Moment& now);

/// In a transaction of the caller's. Priority and latching are those of the rules or of the kind.
RaiseResult RaiseAlarm(Journal& journal, std::span<const AlarmRule> rules, AlarmRaise raise,
                       const Moment& now);

/// In a transaction of the caller's: every active alarm of that kind returns.
void ReturnAlarmsOf(Journal& journal, std::string_view code, double time_s);

/// In a transaction of the caller's, when a person orders the next run, which is the reset of all interlocks:
/// what is active returns, and whatever is raised from now on makes instances of its own.
void ReturnAlarmsOfLastRun(Journal& journal, double time_s);

/// What a person asks for about one alarm.
struct AlarmRequest {
  std::int64_t number{};
  AlarmEvent event{AlarmEvent::kAcknowledge};
  std::string by;
  std::string text;         // why, or the comment itself
  double shelf_length_s{};  // of a kShelve
};

/// In a transaction of its own, beside a program that runs the campaign or alone.
/// @return the alarm as it is now.
/// @throws BenchError with what was expected: no such alarm, not possible in its state, a shelf that is too
///   long or no time at all.
AlarmInstance ActOnAlarm(const CampaignFolder& folder, Journal& journal, const AlarmRequest& request,
                         const Moment& now);

}  // namespace strainwave::bench
