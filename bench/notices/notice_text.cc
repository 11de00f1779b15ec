// SPDX-License-Identifier: Apache-2.0
#include "bench/notices/notice_text.h"

#include <algorithm>
#include <cstddef>
#include <sstream>

#include <fmt/format.h>

#include "bench/escaped.h"

namespace strainwave::bench {
namespace {

constexpr std::size_t kMostSubject_bytes = 160;
constexpr std::size_t kMostNamed = 10;  // notices that a summary names
constexpr std::size_t kMostAlarms = 100;

// Never within a character of UTF-8.
std::string CutTo(std::string text, std::size_t most_bytes) {
  if (text.size() <= most_bytes) return text;
  std::size_t end = most_bytes;
  while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xC0U) == 0x80U) --end;
  return text.substr(0, end) + "…";
}

}  // namespace

std::string AlarmTitle(const NoticedAlarm& alarm) {
  return fmt::format("alarm {} ({}) {}", alarm.number, Name(alarm.priority), Escaped(alarm.code));
}

std::string AlarmLines(const NoticedAlarm& alarm, std::span<const AlarmRule> rules) {
  std::string lines =
      fmt::format("alarm {} ({}): {}: {}\n  raised {} in cycle {}{}\n", alarm.number, Name(alarm.priority),
                  Escaped(alarm.code), Escaped(alarm.text), alarm.raised_utc, alarm.cycle,
                  alarm.phase.empty() ? "" : ", " + Escaped(alarm.phase));
  std::istringstream guidance(GuidanceOf(alarm.code, rules));
  for (std::string line; std::getline(guidance, line);) lines += fmt::format("  to do: {}\n", Escaped(line));
  return lines;
}

std::string AcknowledgeLines(std::span<const NoticedAlarm> alarms, const NoticeView& view) {
  std::string lines;
  for (const NoticedAlarm& alarm : alarms) {
    lines += fmt::format("to say that it was seen: strainwave alarms {} acknowledge {} --by NAME\n",
                         Escaped(view.folder), alarm.number);
  }
  return lines;
}

Notice MakeNotice(NoticeKind kind, AlarmPriority priority, const NoticeView& view, std::string_view title,
                  std::string_view lines, const Moment& now) {
  Notice notice;
  notice.kind = kind;
  notice.priority = priority;
  notice.utc_ms = now.utc_ms;
  notice.campaign = view.campaign;
  notice.specimen = view.specimen;
  notice.state = NameOf(view.view);
  notice.subject =
      CutTo(fmt::format("strainwave {}: {}", Escaped(view.campaign), Escaped(title)), kMostSubject_bytes);
  notice.text = fmt::format("{}campaign {}, specimen {}: {}\n  {}\n  more: strainwave status {}\n", lines,
                            Escaped(view.campaign), Escaped(view.specimen), NameOf(view.view),
                            Escaped(view.sentence), Escaped(view.folder));
  return notice;
}

Notice SummaryNotice(std::span<const Notice> further, const NoticeView& view, const Moment& now) {
  std::string lines =
      fmt::format("{} further notices, more than rate_per_hour leaves room for; see strainwave alarms {}\n",
                  further.size(), Escaped(view.folder));
  AlarmPriority highest = AlarmPriority::kLow;
  for (const Notice& notice : further) highest = std::max(highest, notice.priority);
  for (const Notice& notice : further.first(std::min(further.size(), kMostNamed)))
    lines += fmt::format("  {}\n", notice.subject);
  Notice summary = MakeNotice(NoticeKind::kSummary, highest, view,
                              fmt::format("{} further notices", further.size()), lines, now);
  summary.further = static_cast<int>(further.size());
  summary.audience = further.front().audience;
  for (const Notice& notice : further) {
    if (notice.audience != summary.audience) summary.audience = Audience::kBoth;
    for (const NoticedAlarm& alarm : notice.alarms) {
      if (summary.alarms.size() < kMostAlarms) summary.alarms.push_back(alarm);
    }
  }
  return summary;
}

}  // namespace strainwave::bench
