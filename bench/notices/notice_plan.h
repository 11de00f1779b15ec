// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "bench/notices/notice.h"
#include "bench/notices/notice_view.h"

namespace strainwave::bench {

/// When a notice is due, and how many there may be.
struct NoticeRules {
  double delay_s{120.0};  // an alarm that is acknowledged or cleared within it is not told of
  std::optional<double> escalate_after_s;  // since the first notice; nothing: there is no second list
  double silence_after_s{300.0};           // without a sign of life of a process that holds the campaign
  int per_hour{20};                        // notices at most, at least 2
};

/// An open alarm as the notices have it.
struct KeptAlarm {
  NoticedAlarm alarm;
  Moment raised;
  bool acknowledged{};
  std::optional<Moment> notified;
  std::optional<Moment> escalated;
};

struct KeptSilence {
  Moment notified;
  bool escalated{};
};

/// All that must be known of what was sent, so that a restart tells nothing twice.
struct NoticeMemory {
  std::vector<KeptAlarm> alarms;  // by number
  std::optional<KeptSilence> silence;
  std::string ended_run;  // the last one whose end was told
  std::string run;        // with `view`: what the campaign was at the last look,
  BenchView view{BenchView::kNotBegun};
  Moment since;              // and since when
  std::vector<Moment> sent;  // within the last hour, oldest first
  std::int64_t last_number{};
};

/// The notices that are due now, most urgent first. They count as sent: `memory` is brought up to date.
/// Docs: docs/bench/notices.md#when.
std::vector<Notice> PlanNotices(const NoticeView& view, const NoticeRules& rules, NoticeMemory& memory,
                                const Moment& now);

/// For people who want to see whether notices reach them. Counts for nothing.
Notice TestNotice(const NoticeView& view, const Moment& now);

}  // namespace strainwave::bench
