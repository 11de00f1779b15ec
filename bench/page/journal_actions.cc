// SPDX-License-Identifier: Apache-2.0
#include "bench/page/journal_actions.h"

#include <algorithm>
#include <exception>

#include <fmt/core.h>

#include "bench/campaign/campaign_alarms.h"
#include "bench/errors/bench_error.h"
#include "bench/escaped.h"
#include "bench/utc.h"

namespace strainwave::bench {
namespace {

// Without the folder's name, which the page has no use for.
std::string SentenceOf(const BenchError& error) {
  constexpr std::string_view kMark = "error: ";
  const std::string_view text = error.what();
  const std::size_t mark = text.find(kMark);
  return std::string(mark == text.npos ? text : text.substr(mark + kMark.size()));
}

std::string Act(const CampaignFolder& folder, const AskedAction& asked, const Moment& now) {
  Journal journal = Journal::OpenAsRead(folder.Journal(), Database::Mode::kReadWrite);
  if (std::holds_alternative<NoteRequest>(asked.action->what)) {
    journal.AddOperatorNote({UtcText(now.utc_ms), asked.by, asked.text});
    return "the note is in the journal";
  }
  const AlarmRequest request{.number = asked.alarm,
                             .event = std::get<AlarmEvent>(asked.action->what),
                             .by = asked.by,
                             .text = asked.text,
                             .shelf_length_s = asked.shelf_length_s};
  const AlarmInstance alarm = ActOnAlarm(folder, journal, request, now);
  return fmt::format("alarm {} is {}", alarm.number, Words(alarm.state));
}

}  // namespace

ActionAnswer ActInJournal(const CampaignFolder& folder, const AskedAction& asked, const Moment& now) {
  try {
    return Done(asked, Act(folder, asked, now), UtcText(now.utc_ms));
  } catch (const BenchError& error) {
    return NotDone(409, "state", SentenceOf(error));
  } catch (const std::exception& error) {
    return NotDone(
        503, "journal",
        fmt::format("the journal cannot be written, nothing was done: {} (expected room on the disk, "
                    "and no other program that holds it)",
                    error.what()));
  }
}

void RecordAction(const CampaignFolder& folder, const AskedAction& asked, const CampaignSnapshot& snapshot,
                  const std::string& utc) {
  const CampaignProgress& progress = snapshot.progress;
  Journal journal = Journal::OpenAsRead(folder.Journal(), Database::Mode::kReadWrite);
  const std::string by = asked.by.empty() ? "somebody who was not logged in" : Escaped(asked.by);
  const std::string why = asked.text.empty() ? "" : fmt::format(": {}", Escaped(asked.text));
  journal.AddEvent({.time_s = progress.latest_s,
                    .utc = utc,
                    .cycle = progress.cycle,
                    .phase = progress.phase,
                    .severity = std::string(kActionSeverity),
                    .code = fmt::format("page_{}", asked.action->name),
                    .text = fmt::format("{} asked for on the page by {}{}", asked.action->words, by, why)});
}

std::optional<ActionAnswer> MayNotResume(const CampaignSnapshot& snapshot, const AskedAction& asked) {
  switch (snapshot.view) {
    case BenchView::kRunning:
      return NotDone(409, "running", "the campaign runs already");
    case BenchView::kComplete:
      return NotDone(409, "complete", "all cycles are complete: there is nothing to resume");
    case BenchView::kUnreadable:
      return NotDone(409, "unreadable", snapshot.trouble);
    case BenchView::kFaulted:
    case BenchView::kInterrupted:
      if (asked.text.empty()) {
        return NotDone(
            400, "request",
            "after a fault or an interruption 'text' must say what was looked at and mended before "
            "the campaign goes on (expected words)");
      }
      break;
    case BenchView::kNotBegun:
    case BenchView::kStopped:
      break;
  }
  for (const AlarmInstance& alarm : snapshot.progress.open_alarms) {
    if (IsActive(alarm.state) && !IsAcknowledged(alarm.state)) {
      return NotDone(409, "alarm",
                     fmt::format("alarm {} is not acknowledged: {} (expected that somebody has seen every "
                                 "alarm before the campaign goes on)",
                                 alarm.number, alarm.text));
    }
  }
  return std::nullopt;
}

}  // namespace strainwave::bench
