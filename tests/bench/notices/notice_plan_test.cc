// SPDX-License-Identifier: Apache-2.0
#include "bench/notices/notice_plan.h"

#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "bench/utc.h"

namespace strainwave::bench::notice_plan_test {
namespace {

// 2026-11-02T10:00:00Z, an hour after the machine has started.
constexpr Moment kMorning{1'793'613'600'000, 3'600'000, 7};

Moment At(double time_s) {
  const auto later_ms = static_cast<std::int64_t>(1e3 * time_s);
  return {kMorning.utc_ms + later_ms, kMorning.since_boot_ms + later_ms, kMorning.boot};
}

// "alarm 1 first", "summary both": kind, numbers of alarms, list.
std::string Short(const Notice& notice) {
  constexpr const char* kLists[] = {"first", "second", "both"};
  std::string text(NameOf(notice.kind));
  for (const NoticedAlarm& alarm : notice.alarms) text += " " + std::to_string(alarm.number);
  return text + " " + kLists[static_cast<int>(notice.audience)];
}

class NoticePlan : public testing::Test {
 protected:
  NoticePlan() {
    view_.campaign = "first";
    view_.specimen = "TEST-1";
    view_.folder = "/campaigns/first";
    Become(BenchView::kRunning);
  }

  void Become(BenchView view, const std::string& run = "run-1") {
    view_.view = view;
    view_.run = run;
    view_.sentence = "what it does";
    view_.process = view == BenchView::kRunning ? 42 : 0;
    view_.quiet_s = view == BenchView::kRunning ? std::optional(0.0) : std::nullopt;
  }
  AlarmInstance& Raise(std::int64_t number, double time_s, AlarmPriority priority = AlarmPriority::kMedium) {
    AlarmInstance alarm;
    alarm.number = number;
    alarm.code = "twist_limit";
    alarm.text = "twist is above";
    alarm.priority = priority;
    alarm.raised_utc = alarm.last_raised_utc = UtcText(At(time_s).utc_ms);
    view_.alarms.push_back(alarm);
    return view_.alarms.back();
  }
  void Clear() { view_.alarms.clear(); }

  std::vector<Notice> Look(double time_s) { return PlanNotices(view_, rules_, memory_, At(time_s)); }
  std::vector<std::string> Told(double time_s) {
    std::vector<std::string> told;
    for (const Notice& notice : Look(time_s)) told.push_back(Short(notice));
    return told;
  }
  using Texts = std::vector<std::string>;

  NoticeRules rules_{.delay_s = 120.0, .escalate_after_s = 1800.0, .silence_after_s = 300.0, .per_hour = 20};
  NoticeView view_;
  NoticeMemory memory_;
};

TEST_F(NoticePlan, TellsOfAnAlarmOnceAfterTheDelay) {
  Raise(1, 10.0);
  EXPECT_EQ(Told(10.0), Texts{});
  EXPECT_EQ(Told(129.9), Texts{});
  EXPECT_EQ(Told(130.0), Texts{"alarm 1 first"});
  EXPECT_EQ(Told(131.0), Texts{});
}

TEST_F(NoticePlan, SaysWhatTheAlarmIsAndHowToAcknowledgeIt) {
  view_.rules = {{"twist_limit", {}, {}, "look at the brake"}};
  Raise(3, 0.0, AlarmPriority::kHigh);
  const std::vector<Notice> told = Look(200.0);
  ASSERT_EQ(told.size(), 1U);
  EXPECT_EQ(told[0].subject, "strainwave first: alarm 3 (high) twist_limit");
  EXPECT_EQ(told[0].text,
            "alarm 3 (high): twist_limit: twist is above\n"
            "  raised 2026-11-02T10:00:00.000Z in cycle 0\n"
            "  to do: look at the brake\n"
            "to say that it was seen: strainwave alarms /campaigns/first acknowledge 3 --by NAME\n"
            "campaign first, specimen TEST-1: running\n"
            "  what it does\n"
            "  more: strainwave status /campaigns/first\n");
  EXPECT_EQ(told[0].id, "1793613800000-1");
}

TEST_F(NoticePlan, TellsNothingOfWhatIsAcknowledgedOrClearedInTime) {
  Raise(1, 0.0).state = AlarmInstanceState::kRaised;
  Raise(2, 0.0);
  EXPECT_EQ(Told(60.0), Texts{});
  view_.alarms[0].state = AlarmInstanceState::kAcknowledged;
  view_.alarms.pop_back();
  EXPECT_EQ(Told(1000.0), Texts{});
  Clear();
  EXPECT_EQ(Told(1001.0), Texts{}) << "a clear is told of what was told alone";
}

TEST_F(NoticePlan, TellsOfAnAlarmThatHasReturnedUnseen) {
  Raise(1, 0.0).state = AlarmInstanceState::kReturned;
  EXPECT_EQ(Told(200.0), Texts{"alarm 1 first"});
}

TEST_F(NoticePlan, TellsNothingWhileAnAlarmIsShelved) {
  Raise(1, 0.0).state = AlarmInstanceState::kShelvedRaised;
  EXPECT_EQ(Told(1000.0), Texts{});
  view_.alarms[0].state = AlarmInstanceState::kRaised;
  EXPECT_EQ(Told(1001.0), Texts{"alarm 1 first"});
  view_.alarms[0].state = AlarmInstanceState::kShelvedRaised;
  EXPECT_EQ(Told(9000.0), Texts{}) << "nor is it escalated";
}

TEST_F(NoticePlan, EscalatesOnceWhatNobodyAcknowledges) {
  Raise(1, 0.0);
  EXPECT_EQ(Told(200.0), Texts{"alarm 1 first"});
  EXPECT_EQ(Told(1999.0), Texts{});
  EXPECT_EQ(Told(2000.0), Texts{"escalation 1 second"});
  EXPECT_EQ(Told(9000.0), Texts{});
}

TEST_F(NoticePlan, EscalatesNothingThatIsAcknowledgedNorWithoutASecondList) {
  Raise(1, 0.0);
  Raise(2, 0.0);
  EXPECT_EQ(Told(200.0), (Texts{"alarm 1 first", "alarm 2 first"}));
  view_.alarms[0].state = AlarmInstanceState::kAcknowledged;
  rules_.escalate_after_s.reset();
  EXPECT_EQ(Told(9000.0), Texts{});
  rules_.escalate_after_s = 1800.0;
  EXPECT_EQ(Told(9001.0), Texts{"escalation 2 second"});
}

TEST_F(NoticePlan, FollowsUpOnceWhenWhatWasToldHasCleared) {
  Raise(1, 0.0);
  Told(200.0);
  view_.alarms[0].state = AlarmInstanceState::kAcknowledged;
  EXPECT_EQ(Told(300.0), Texts{});
  Clear();
  EXPECT_EQ(Told(400.0), Texts{"cleared 1 first"});
  EXPECT_EQ(Told(401.0), Texts{});
}

TEST_F(NoticePlan, FollowsUpToEverybodyWhoWasTold) {
  Raise(1, 0.0);
  Told(200.0);
  Told(3000.0);
  Clear();
  EXPECT_EQ(Told(3001.0), Texts{"cleared 1 both"});
}

TEST_F(NoticePlan, BeginsAnewWithAnAlarmThatAsksToBeAcknowledgedAgain) {
  Raise(1, 0.0);
  Told(200.0);
  view_.alarms[0].state = AlarmInstanceState::kAcknowledged;
  EXPECT_EQ(Told(300.0), Texts{});
  view_.alarms[0].state = AlarmInstanceState::kRaised;
  view_.alarms[0].last_raised_utc = UtcText(At(400.0).utc_ms);
  EXPECT_EQ(Told(400.0), Texts{});
  EXPECT_EQ(Told(520.0), Texts{"alarm 1 first"});
}

TEST_F(NoticePlan, TellsOfAFaultTogetherWithWhatWasRaised) {
  Raise(1, 0.0, AlarmPriority::kHigh);
  Raise(2, 0.1);
  Become(BenchView::kFaulted);
  EXPECT_EQ(Told(1.0), Texts{});
  EXPECT_EQ(Told(119.9), Texts{});
  EXPECT_EQ(Told(120.0), Texts{"fault 1 2 first"});
  EXPECT_EQ(Told(200.0), Texts{}) << "each of them is told once";
  EXPECT_EQ(Told(1920.0), (Texts{"escalation 1 second", "escalation 2 second"}));
}

TEST_F(NoticePlan, TellsOfNoFaultThatSomebodyIsAtAlready) {
  Raise(1, 0.0, AlarmPriority::kHigh).state = AlarmInstanceState::kAcknowledged;
  Become(BenchView::kFaulted);
  EXPECT_EQ(Told(1.0), Texts{});
  EXPECT_EQ(Told(5000.0), Texts{});
}

TEST_F(NoticePlan, TellsOfAFaultWhoseAlarmWasToldBefore) {
  Raise(1, 0.0);
  EXPECT_EQ(Told(120.0), Texts{"alarm 1 first"});
  Become(BenchView::kFaulted);
  EXPECT_EQ(Told(121.0), Texts{});
  EXPECT_EQ(Told(241.0), Texts{"fault first"});
}

TEST_F(NoticePlan, TellsOfTheEndOfACampaignAtOnceAndOfAStopAfterTheDelay) {
  Become(BenchView::kStopped);
  EXPECT_EQ(Told(0.0), Texts{});
  EXPECT_EQ(Told(120.0), Texts{"stopped first"});
  Become(BenchView::kRunning, "run-2");
  EXPECT_EQ(Told(200.0), Texts{});
  Become(BenchView::kStopped, "run-2");
  EXPECT_EQ(Told(300.0), Texts{});
  Become(BenchView::kRunning, "run-3");
  EXPECT_EQ(Told(400.0), Texts{}) << "it went on within the delay";
  Become(BenchView::kComplete, "run-3");
  EXPECT_EQ(Told(500.0), Texts{"complete first"});
  EXPECT_EQ(Told(501.0), Texts{});
}

TEST_F(NoticePlan, TellsOfAProgramThatIsGoneAtOnceAndOfItsReturn) {
  EXPECT_EQ(Told(0.0), Texts{});
  Become(BenchView::kInterrupted);
  EXPECT_EQ(Told(1.0), Texts{"silence first"});
  EXPECT_EQ(Told(2.0), Texts{});
  EXPECT_EQ(Told(1801.0), Texts{"escalation second"});
  EXPECT_EQ(Told(1802.0), Texts{});
  Become(BenchView::kRunning, "run-2");
  EXPECT_EQ(Told(2000.0), Texts{"spoke_again both"});
  EXPECT_EQ(Told(2001.0), Texts{});
}

TEST_F(NoticePlan, TellsOfAProgramWithoutASignOfLife) {
  view_.quiet_s = 299.0;
  EXPECT_EQ(Told(1000.0), Texts{});
  view_.quiet_s = 300.0;
  const std::vector<Notice> told = Look(1001.0);
  ASSERT_EQ(told.size(), 1U);
  EXPECT_EQ(Short(told[0]), "silence first");
  EXPECT_EQ(
      told[0].text.substr(0, told[0].text.find('\n')),
      "process 42 has the campaign and has given no sign of life for 300 s: no readings, no checkpoint");
  view_.quiet_s = 1.0;
  EXPECT_EQ(Told(1002.0), Texts{"spoke_again first"});
}

TEST_F(NoticePlan, CountsFromTheFirstLookWhereNoSignOfLifeIsKnown) {
  view_.quiet_s.reset();
  EXPECT_EQ(Told(0.0), Texts{});
  EXPECT_EQ(Told(299.0), Texts{});
  EXPECT_EQ(Told(300.0), Texts{"silence first"});
}

TEST_F(NoticePlan, TakesAFolderThatCannotBeReadForSilenceAndForNoNews) {
  Raise(1, 0.0);
  EXPECT_EQ(Told(200.0), Texts{"alarm 1 first"});
  Clear();
  Become(BenchView::kUnreadable);
  EXPECT_EQ(Told(201.0), Texts{}) << "nothing has cleared";
  EXPECT_EQ(Told(501.0), Texts{"silence first"});
  Become(BenchView::kRunning);
  Raise(1, 0.0);
  EXPECT_EQ(Told(502.0), Texts{"spoke_again first"});
}

TEST_F(NoticePlan, LetsWhatIsUrgentGoFirst) {
  Raise(1, 0.0, AlarmPriority::kLow);
  Raise(2, 0.0, AlarmPriority::kMedium);
  Raise(3, 0.0, AlarmPriority::kHigh);
  EXPECT_EQ(Told(200.0), (Texts{"alarm 3 first", "alarm 2 first", "alarm 1 first"}));
}

TEST_F(NoticePlan, TellsTheRestInOneWhereThereIsNoRoom) {
  rules_.escalate_after_s.reset();
  rules_.per_hour = 4;  // three of which others than urgent ones may use
  for (int number = 1; number <= 14; ++number) Raise(number, 0.0);
  const std::vector<Notice> told = Look(200.0);
  ASSERT_EQ(told.size(), 3U);
  EXPECT_EQ(Short(told[1]), "alarm 2 first");
  EXPECT_EQ(told[2].subject, "strainwave first: 12 further notices");
  EXPECT_EQ(told[2].further, 12);
  EXPECT_EQ(told[2].alarms.size(), 12U);
  EXPECT_EQ(told[2].text.substr(0, told[2].text.find("\n  strainwave first: alarm 4")),
            "12 further notices, more than rate_per_hour leaves room for; see strainwave alarms "
            "/campaigns/first\n  strainwave first: alarm 3 (medium) twist_limit");
  Raise(15, 200.0);
  EXPECT_EQ(Told(400.0), Texts{}) << "nothing of medium priority has room";
  Raise(16, 300.0, AlarmPriority::kHigh);
  EXPECT_EQ(Told(500.0), Texts{"alarm 16 first"}) << "what is urgent has";
  EXPECT_EQ(Told(3799.0), Texts{}) << "not within the hour";
  EXPECT_EQ(Told(3800.0).front(), "alarm 15 first");
}

TEST_F(NoticePlan, KeepsControlCharactersOutOfSubjectAndLines) {
  AlarmInstance& alarm = Raise(1, 0.0);
  alarm.code = "a\r\nBcc: all@example.org";
  alarm.text = "seen\nSubject: other\x1b[31m";
  const std::vector<Notice> told = Look(200.0);
  ASSERT_EQ(told.size(), 1U);
  EXPECT_EQ(told[0].subject.find_first_of("\r\n"), std::string::npos);
  EXPECT_EQ(told[0].text.substr(0, told[0].text.find('\n')),
            R"(alarm 1 (medium): a\x0d\nBcc: all@example.org: seen\nSubject: other\x1b[31m)");
}

TEST_F(NoticePlan, HasADelayThatNoClockSetBackMakesLonger) {
  Raise(1, 0.0);
  EXPECT_EQ(Told(0.0), Texts{});
  const Moment set_back{kMorning.utc_ms - 86'400'000, kMorning.since_boot_ms + 120'000, kMorning.boot};
  EXPECT_EQ(PlanNotices(view_, rules_, memory_, set_back).size(), 1U);
}

}  // namespace
}  // namespace strainwave::bench::notice_plan_test
