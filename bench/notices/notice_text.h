// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "bench/notices/notice.h"
#include "bench/notices/notice_view.h"

/// What notices say: whatever people or devices have written in it is escaped, so that no text makes a header
/// of a mail or a line of its own.
namespace strainwave::bench {

/// A notice of that kind with what every one has: what the campaign does, and where to look.
/// @param title  follows the campaign's name in the subject; cut where it is long.
/// @param lines  stand before what the campaign does, each ended with "\n".
Notice MakeNotice(NoticeKind kind, AlarmPriority priority, const NoticeView& view, std::string_view title,
                  std::string_view lines, const Moment& now);

/// "alarm 3 (high): twist_limit: …", with cycle, phase, time and what the bench file says to do.
std::string AlarmLines(const NoticedAlarm& alarm, std::span<const AlarmRule> rules);
/// "alarm 3 (high) twist_limit"
std::string AlarmTitle(const NoticedAlarm& alarm);
/// What can be typed about alarms.
std::string AcknowledgeLines(std::span<const NoticedAlarm> alarms, const NoticeView& view);

/// Of several that stand for themselves no more.
Notice SummaryNotice(std::span<const Notice> further, const NoticeView& view, const Moment& now);

}  // namespace strainwave::bench
