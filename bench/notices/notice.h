// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "bench/alarms/alarm_list.h"

namespace strainwave::bench {

enum class NoticeKind {
  kAlarm,       // raised, and nobody has acknowledged it
  kEscalation,  // told before, and still nobody has
  kCleared,     // an alarm that was told of is over
  kFault,       // a run was ended by a fault
  kStopped,     // a run has ended on request or by a stop criterion
  kComplete,    // all cycles are done
  kSilence,     // nothing is heard of a run any more
  kSpokeAgain,  // after a silence that was told of
  kSummary,     // of what the rate limit has left no room for
  kTest,
};

/// "alarm", "spoke_again", …; as programs see it.
std::string_view NameOf(NoticeKind kind);

/// Which of the two lists of a mail; other channels get every notice.
enum class Audience { kFirst, kSecond, kBoth };

/// Of an alarm, what a notice tells programs.
struct NoticedAlarm {
  std::int64_t number{};
  std::string code;
  std::string text;
  AlarmPriority priority{AlarmPriority::kMedium};
  int cycle{};
  std::string phase;
  std::string raised_utc;
};
NoticedAlarm NoticedOf(const AlarmInstance& instance);

/// One message, alike for every channel.
struct Notice {
  std::string id;  // no other notice of the campaign has it, and every try to send this one does
  NoticeKind kind{NoticeKind::kTest};
  AlarmPriority priority{AlarmPriority::kMedium};
  Audience audience{Audience::kFirst};
  std::int64_t utc_ms{};
  std::string campaign;  // name of its folder
  std::string specimen;
  std::string state;    // of the campaign, as the live page names it
  std::string subject;  // one line of UTF-8 without control characters
  std::string text;     // lines of the same
  std::vector<NoticedAlarm> alarms;
  int further{};  // of a summary: how many notices it stands for
};

/// docs/bench/notices.md#json. Text that is no UTF-8 is shown as `Escaped` does.
nlohmann::json NoticeJson(const Notice& notice);
/// What NoticeJson has made. @throws std::exception for anything else.
Notice NoticeFrom(const nlohmann::json& json);

}  // namespace strainwave::bench
