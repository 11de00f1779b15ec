// SPDX-License-Identifier: Apache-2.0
#include "bench/notices/notice_plan.h"

#include <algorithm>
#include <functional>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "bench/notices/notice_rate.h"
#include "bench/notices/notice_text.h"

namespace strainwave::bench {
namespace {

// A notice that is due, and what is different once it is sent.
struct DueNotice {
  Notice notice;
  std::function<void()> sent;
};

double Elapsed_s(const Moment& since, const Moment& now) {
  // What no clock can tell is taken for longer than any.
  return PauseBetween(since, now).length_s.value_or(std::numeric_limits<double>::infinity());
}

bool IsUrgent(const DueNotice& due) { return due.notice.priority == AlarmPriority::kHigh; }

class Planner {
 public:
  Planner(const NoticeView& view, const NoticeRules& rules, NoticeMemory& memory, const Moment& now)
      : view_(view), rules_(rules), memory_(memory), now_(now) {}

  std::vector<Notice> Plan() {
    NoteView();
    PlanSilence();
    // What was read last is no news of a campaign that cannot be read.
    if (view_.view != BenchView::kUnreadable) {
      NoteAlarms();
      PlanEnd();
      PlanAlarms();
    }
    return TakeAsRoomAllows();
  }

 private:
  void NoteView() {
    if (memory_.run == view_.run && memory_.view == view_.view) return;
    memory_.run = view_.run;
    memory_.view = view_.view;
    memory_.since = now_;
  }

  void Add(Notice notice, std::function<void()> sent) {
    due_.push_back({std::move(notice), std::move(sent)});
  }
  Notice Make(NoticeKind kind, AlarmPriority priority, std::string_view title,
              std::string_view lines = {}) const {
    return MakeNotice(kind, priority, view_, title, lines, now_);
  }

  bool IsSilent() const {
    const double seen_s = Elapsed_s(memory_.since, now_);
    switch (view_.view) {
      case BenchView::kInterrupted:
        return true;
      case BenchView::kUnreadable:
        return seen_s >= rules_.silence_after_s;
      case BenchView::kRunning:
        return view_.quiet_s.value_or(seen_s) >= rules_.silence_after_s;
      case BenchView::kNotBegun:
      case BenchView::kStopped:
      case BenchView::kComplete:
      case BenchView::kFaulted:
        return false;
    }
    return false;
  }

  std::string SilenceLines() const {
    if (view_.view != BenchView::kRunning) return {};
    return fmt::format(
        "process {} has the campaign and has given no sign of life for {:.0f} s: no readings, no "
        "checkpoint\n  Is it frozen, is the disk, or does it wait for somebody at the bench? Look at the "
        "bench before anybody goes near.\n",
        view_.process, view_.quiet_s.value_or(Elapsed_s(memory_.since, now_)));
  }

  void PlanSilence() {
    std::optional<KeptSilence>& kept = memory_.silence;
    if (IsSilent()) {
      if (!kept) {
        Add(Make(NoticeKind::kSilence, AlarmPriority::kHigh, "nothing is heard of the run", SilenceLines()),
            [this] {
              memory_.silence = KeptSilence{now_, false};
            });
      } else if (IsToEscalate(kept->notified, kept->escalated)) {
        Notice notice = Make(NoticeKind::kEscalation, AlarmPriority::kHigh,
                             "still nothing is heard of the run", SilenceLines());
        notice.audience = Audience::kSecond;
        Add(std::move(notice), [this] { memory_.silence->escalated = true; });
      }
    } else if (kept && view_.view != BenchView::kUnreadable) {
      Notice notice = Make(NoticeKind::kSpokeAgain, AlarmPriority::kMedium, "the campaign is heard of again");
      if (kept->escalated) notice.audience = Audience::kBoth;
      Add(std::move(notice), [this] { memory_.silence.reset(); });
    }
  }

  bool IsToEscalate(const Moment& notified, bool escalated) const {
    return rules_.escalate_after_s && !escalated && Elapsed_s(notified, now_) >= *rules_.escalate_after_s;
  }

  // Takes up alarms that are new, and those that ask to be acknowledged again.
  void NoteAlarms() {
    for (const AlarmInstance& instance : view_.alarms) {
      const auto kept = std::ranges::find(memory_.alarms, instance.number,
                                          [](const KeptAlarm& known) { return known.alarm.number; });
      const bool acknowledged = IsAcknowledged(instance.state);
      const bool again = kept != memory_.alarms.end() && kept->acknowledged && !acknowledged;
      if (kept != memory_.alarms.end() && !again) {
        kept->acknowledged = acknowledged;
        continue;
      }
      KeptAlarm fresh{NoticedOf(instance), MomentOf(instance.last_raised_utc, now_), acknowledged, {}, {}};
      if (again) {
        *kept = std::move(fresh);
      } else {
        memory_.alarms.push_back(std::move(fresh));
      }
    }
  }

  const AlarmInstance* Open(const KeptAlarm& kept) const {
    const auto found = std::ranges::find(view_.alarms, kept.alarm.number, &AlarmInstance::number);
    return found == view_.alarms.end() ? nullptr : &*found;
  }
  bool Waits(const KeptAlarm& kept) const {
    const AlarmInstance* const open = Open(kept);
    return open != nullptr && !IsShelved(open->state) && !IsAcknowledged(open->state);
  }
  bool IsDue(const KeptAlarm& kept) const {
    return !kept.notified && Waits(kept) && Elapsed_s(kept.raised, now_) >= rules_.delay_s;
  }

  // Of a run; what has ended it, and is not told yet, is told with it.
  void PlanEnd() {
    const bool faulted = view_.view == BenchView::kFaulted;
    const bool stopped = view_.view == BenchView::kStopped;
    const bool complete = view_.view == BenchView::kComplete;
    if (!(faulted || stopped || complete) || memory_.ended_run == view_.run) return;
    const bool alarm_is_due =
        std::ranges::any_of(memory_.alarms, [this](const KeptAlarm& kept) { return IsDue(kept); });
    const bool delay_is_over = Elapsed_s(memory_.since, now_) >= rules_.delay_s;
    const bool nobody_knows =
        stopped || view_.alarms.empty() ||
        std::ranges::any_of(memory_.alarms, [this](const KeptAlarm& kept) { return Waits(kept); });
    if (!(complete || alarm_is_due || (delay_is_over && nobody_knows))) return;
    std::vector<std::int64_t> numbers;
    std::vector<NoticedAlarm> alarms;
    std::string lines;
    for (const KeptAlarm& kept : memory_.alarms) {
      if (kept.notified || !Waits(kept)) continue;
      numbers.push_back(kept.alarm.number);
      alarms.push_back(kept.alarm);
      lines += AlarmLines(kept.alarm, view_.rules);
    }
    lines += AcknowledgeLines(alarms, view_);
    Notice notice =
        faulted    ? Make(NoticeKind::kFault, AlarmPriority::kHigh, "fault: " + view_.sentence, lines)
        : complete ? Make(NoticeKind::kComplete, AlarmPriority::kMedium, "complete", lines)
                   : Make(NoticeKind::kStopped, AlarmPriority::kMedium, "stopped: " + view_.sentence, lines);
    notice.alarms = std::move(alarms);
    told_with_end_ = numbers;
    Add(std::move(notice), [this, numbers = std::move(numbers)] {
      memory_.ended_run = view_.run;
      for (KeptAlarm& kept : memory_.alarms) {
        if (std::ranges::find(numbers, kept.alarm.number) != numbers.end()) kept.notified = now_;
      }
    });
  }

  KeptAlarm& Kept(std::int64_t number) {
    return *std::ranges::find(memory_.alarms, number,
                              [](const KeptAlarm& known) { return known.alarm.number; });
  }

  void PlanAlarms() {
    std::erase_if(memory_.alarms,
                  [this](const KeptAlarm& kept) { return !kept.notified && Open(kept) == nullptr; });
    for (const KeptAlarm& kept : memory_.alarms) {
      const std::int64_t number = kept.alarm.number;
      if (Open(kept) == nullptr) {
        PlanCleared(kept);
      } else if (IsDue(kept) && std::ranges::find(told_with_end_, number) == told_with_end_.end()) {
        AddAlarm(NoticeKind::kAlarm, kept, AlarmTitle(kept.alarm),
                 [this, number] { Kept(number).notified = now_; });
      } else if (kept.notified && Waits(kept) && IsToEscalate(*kept.notified, kept.escalated.has_value())) {
        AddAlarm(NoticeKind::kEscalation, kept, AlarmTitle(kept.alarm) + " is not acknowledged",
                 [this, number] { Kept(number).escalated = now_; });
      }
    }
  }

  void AddAlarm(NoticeKind kind, const KeptAlarm& kept, const std::string& title,
                std::function<void()> sent) {
    const std::string lines = AlarmLines(kept.alarm, view_.rules) + AcknowledgeLines({&kept.alarm, 1}, view_);
    Notice notice = Make(kind, kept.alarm.priority, title, lines);
    notice.alarms = {kept.alarm};
    if (kind == NoticeKind::kEscalation) notice.audience = Audience::kSecond;
    Add(std::move(notice), std::move(sent));
  }

  void PlanCleared(const KeptAlarm& kept) {
    const std::int64_t number = kept.alarm.number;
    Notice notice = Make(NoticeKind::kCleared, AlarmPriority::kLow, AlarmTitle(kept.alarm) + " has cleared",
                         AlarmLines(kept.alarm, {}));
    notice.alarms = {kept.alarm};
    if (kept.escalated) notice.audience = Audience::kBoth;
    Add(std::move(notice), [this, number] {
      std::erase_if(memory_.alarms, [&](const KeptAlarm& known) { return known.alarm.number == number; });
    });
  }

  std::vector<Notice> TakeAsRoomAllows() {
    // Among equals in the order in which they were found: silence, end, alarms by number.
    std::ranges::stable_sort(due_, std::greater<>(),
                             [](const DueNotice& due) { return due.notice.priority; });
    ForgetSent(memory_.sent, now_);
    const auto urgent = static_cast<std::size_t>(std::ranges::count_if(due_, IsUrgent));
    const NoticeRoom room = RoomFor(urgent, due_.size() - urgent, memory_.sent.size(), rules_.per_hour);
    std::vector<Notice> all;
    std::vector<Notice> further;
    for (std::size_t i = 0; i < due_.size(); ++i) {
      if (i >= room.by_themselves && !room.summary) break;
      due_[i].sent();
      (i < room.by_themselves ? all : further).push_back(std::move(due_[i].notice));
    }
    if (!further.empty()) all.push_back(SummaryNotice(further, view_, now_));
    for (Notice& notice : all) {
      memory_.sent.push_back(now_);
      notice.id = fmt::format("{}-{}", now_.utc_ms, ++memory_.last_number);
    }
    return all;
  }

  const NoticeView& view_;
  const NoticeRules& rules_;
  NoticeMemory& memory_;
  const Moment& now_;
  std::vector<DueNotice> due_;
  std::vector<std::int64_t> told_with_end_;  // numbers of alarms
};

}  // namespace

std::vector<Notice> PlanNotices(const NoticeView& view, const NoticeRules& rules, NoticeMemory& memory,
                                const Moment& now) {
  return Planner(view, rules, memory, now).Plan();
}

Notice TestNotice(const NoticeView& view, const Moment& now) {
  Notice notice = MakeNotice(NoticeKind::kTest, AlarmPriority::kLow, view, "test",
                             "a test: notices of this campaign come this way\n", now);
  notice.audience = Audience::kBoth;
  notice.id = fmt::format("{}-test", now.utc_ms);
  return notice;
}

}  // namespace strainwave::bench
