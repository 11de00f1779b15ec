// SPDX-License-Identifier: Apache-2.0
#include "bench/campaign/campaign_alarms.h"

#include <unistd.h>

#include <filesystem>
#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "bench/errors/bench_error.h"
#include "bench/safety/stop_reason.h"

namespace strainwave::bench::campaign_alarms_test {
namespace {

constexpr double kAll_s = -std::numeric_limits<double>::infinity();
constexpr double kOpenAlone_s = std::numeric_limits<double>::infinity();

// 2026-11-02T10:00:00Z, an hour after the machine has started.
constexpr Moment kMorning{1'793'613'600'000, 3'600'000, 7};
Moment After(double time_s) {
  const auto later_ms = static_cast<std::int64_t>(1e3 * time_s);
  return {kMorning.utc_ms + later_ms, kMorning.since_boot_ms + later_ms, kMorning.boot};
}

class CampaignAlarms : public testing::Test {
 protected:
  CampaignAlarms() { std::filesystem::create_directories(folder_.root); }
  ~CampaignAlarms() override { std::filesystem::remove_all(folder_.root); }

  void RaiseAt(double time_s, const std::string& code = "twist_limit") {
    Transaction transaction(journal_.database());
    RaiseAlarm(journal_, rules_, {.code = code, .text = "what was seen", .cycle = 1, .time_s = time_s},
               kMorning);
    transaction.Commit();
  }
  void BeginNextRun(double time_s) {
    Transaction transaction(journal_.database());
    ReturnAlarmsOfLastRun(journal_, time_s);
    transaction.Commit();
  }
  AlarmInstance Ask(std::int64_t number, AlarmEvent event, const Moment& now = kMorning,
                    double length_s = 0.0) {
    return ActOnAlarm(folder_, journal_, {number, event, "A. Meier", "why not", length_s}, now);
  }
  std::string Refusal(std::int64_t number, AlarmEvent event, double length_s = 0.0) {
    try {
      Ask(number, event, kMorning, length_s);
    } catch (const BenchError& error) {
      EXPECT_EQ(error.exit_code(), ExitCode::kWrongInput);
      const std::string text = error.what();
      const std::string root = folder_.root.string();
      return text.starts_with(root) ? text.substr(root.size()) : text;
    }
    return "none";
  }
  void Reopen() {
    journal_ = Journal::Create(":memory:");  // lets go of the file
    journal_ = Journal::Open(folder_.Journal(), Database::Mode::kReadWrite);
  }
  std::vector<AlarmInstance> OpenAt(const Moment& now) {
    std::vector<AlarmInstance> open = journal_.Alarms(kOpenAlone_s);
    TakeOffShelves(open, now);
    return open;
  }

  CampaignFolder folder_{std::filesystem::temp_directory_path() /
                         ("strainwave_campaign_alarms_test_" + std::to_string(::getpid()))};
  std::vector<AlarmRule> rules_;
  Journal journal_ = [this] {
    std::filesystem::create_directories(folder_.root);
    return Journal::Create(folder_.Journal());
  }();
};

TEST_F(CampaignAlarms, KeepWhoAcknowledgedOverARestart) {
  RaiseAt(100.0);
  RaiseAt(100.4, "drive_fault");
  Ask(1, AlarmEvent::kAcknowledge, After(60.0));
  Reopen();
  BeginNextRun(101.0);
  Reopen();
  const auto open = journal_.Alarms(kOpenAlone_s);
  ASSERT_EQ(open.size(), 2U);
  EXPECT_EQ(open[0].state, AlarmInstanceState::kLatched) << "a limit of the specimen latches";
  EXPECT_EQ(open[0].acknowledged_by, "A. Meier");
  EXPECT_EQ(open[0].acknowledged_utc, "2026-11-02T10:01:00.000Z");
  EXPECT_TRUE(open[0].first_out);
  EXPECT_EQ(open[0].priority, AlarmPriority::kHigh);
  EXPECT_EQ(open[0].raised_utc, "2026-11-02T10:00:00.000Z");
  EXPECT_EQ(open[1].state, AlarmInstanceState::kReturned);
  EXPECT_EQ(open[1].acknowledged_by, "");
  EXPECT_FALSE(open[1].first_out);
  const auto actions = journal_.AlarmActions();
  ASSERT_EQ(actions.size(), 1U);
  EXPECT_EQ(actions[0].action, "acknowledge");
  EXPECT_EQ(actions[0].by, "A. Meier");
  EXPECT_EQ(actions[0].text, "why not");
}

TEST_F(CampaignAlarms, OfOneInterlockInTwoRunsAreTwoThoughTheBenchTimeStoodStill) {
  RaiseAt(100.0);
  BeginNextRun(100.0);
  RaiseAt(101.0);
  Ask(2, AlarmEvent::kAcknowledge);
  const auto open = journal_.Alarms(kOpenAlone_s);
  ASSERT_EQ(open.size(), 2U);
  EXPECT_EQ(open[0].state, AlarmInstanceState::kReturned) << "acknowledging one hides no other";
  EXPECT_EQ(open[1].state, AlarmInstanceState::kAcknowledged);
  EXPECT_EQ(open[1].number, 2);
}

TEST_F(CampaignAlarms, ThatAreClearedStayInTheHistory) {
  RaiseAt(100.0, "stop_criterion");
  {
    Transaction transaction(journal_.database());
    ReturnAlarmsOf(journal_, "stop_criterion", 100.0);
    transaction.Commit();
  }
  Ask(1, AlarmEvent::kAcknowledge);
  EXPECT_TRUE(journal_.Alarms(kOpenAlone_s).empty());
  const auto all = journal_.Alarms(kAll_s);
  ASSERT_EQ(all.size(), 1U);
  EXPECT_EQ(all[0].state, AlarmInstanceState::kCleared);
  EXPECT_EQ(all[0].acknowledged_by, "A. Meier");
}

TEST_F(CampaignAlarms, ThatAreTwoThousandEventsOldAreStillOpen) {
  RaiseAt(100.0);
  {
    Transaction transaction(journal_.database());
    for (int i = 0; i < 2000; ++i) journal_.AddEvent({101.0, "", 1, "", "warning", "failed_check", ""});
    transaction.Commit();
  }
  EXPECT_EQ(journal_.Alarms(kOpenAlone_s).size(), 1U);
}

TEST_F(CampaignAlarms, ChatterIsCountedInTheJournal) {
  for (int i = 0; i < 50; ++i) {
    RaiseAt(100.0 + i, "drive_silent");
    Transaction transaction(journal_.database());
    ReturnAlarmsOf(journal_, "drive_silent", 100.5 + i);
    transaction.Commit();
  }
  const auto open = journal_.Alarms(kAll_s);
  ASSERT_EQ(open.size(), 1U);
  EXPECT_EQ(open[0].count, 50);
  EXPECT_EQ(open[0].last_raised_s, 149.0);
}

TEST_F(CampaignAlarms, FirstOutGoesToAnEarlierOneInTheJournalToo) {
  RaiseAt(100.5, "drive_fault");
  RaiseAt(100.1, "brake_engaged");
  const auto open = journal_.Alarms(kOpenAlone_s);
  EXPECT_FALSE(open.at(0).first_out);
  EXPECT_TRUE(open.at(1).first_out);
}

TEST_F(CampaignAlarms, ComeOffTheirShelfWhenItsTimeIsOver) {
  RaiseAt(100.0);
  Ask(1, AlarmEvent::kShelve, kMorning, 1800.0);
  EXPECT_EQ(OpenAt(After(1799.0)).at(0).state, AlarmInstanceState::kShelvedRaised);
  EXPECT_EQ(OpenAt(After(1800.0)).at(0).state, AlarmInstanceState::kRaised);
  EXPECT_EQ(journal_.Alarms(kOpenAlone_s).at(0).state, AlarmInstanceState::kShelvedRaised)
      << "who reads writes nothing";
  Ask(1, AlarmEvent::kComment, After(1801.0));
  EXPECT_EQ(journal_.Alarms(kOpenAlone_s).at(0).state, AlarmInstanceState::kRaised);
  const auto actions = journal_.AlarmActions();
  ASSERT_EQ(actions.size(), 3U);
  EXPECT_EQ(actions[1].action, "shelf_over");
  EXPECT_EQ(actions[1].by, "");
}

TEST_F(CampaignAlarms, StayOnTheirShelfNoLongerWhenTheClockIsSetBack) {
  RaiseAt(100.0);
  Ask(1, AlarmEvent::kShelve, kMorning, 1800.0);
  Moment set_back = After(1801.0);
  set_back.utc_ms -= 7'200'000;
  EXPECT_EQ(OpenAt(set_back).at(0).state, AlarmInstanceState::kRaised) << "the boot's clock goes on";
  // After a restart of the machine nobody knows; then it is seen rather than not.
  EXPECT_EQ(OpenAt({kMorning.utc_ms - 7'200'000, 60'000, 8}).at(0).state, AlarmInstanceState::kRaised);
}

TEST_F(CampaignAlarms, TakePriorityAndLatchingFromTheBenchFileWhereItSaysSo) {
  rules_ = {{"twist_limit", AlarmPriority::kLow, false, "look at the brake"}};
  RaiseAt(100.0);
  RaiseAt(200.0, "output_torque_limit");
  const auto open = journal_.Alarms(kOpenAlone_s);
  EXPECT_EQ(open.at(0).priority, AlarmPriority::kLow);
  EXPECT_FALSE(open.at(0).latching);
  EXPECT_EQ(open.at(1).priority, AlarmPriority::kHigh);
  EXPECT_TRUE(open.at(1).latching);
}

// As the program wrote it before there were instances.
TEST_F(CampaignAlarms, OfAnEarlierJournalAreThoseOfItsEvents) {
  journal_.database().Execute("DROP TABLE alarm_actions; DROP TABLE alarms");
  journal_.AddEvent({1.0, "2026-11-01T00:00:00.000Z", 1, "", "alarm", "drive_fault", "over and done"});
  journal_.AddEvent({2.0, "", 1, "", "info", "resume", ""});
  journal_.AddEvent({3.0, "2026-11-01T01:00:00.000Z", 2, "load", "alarm", "twist_limit", "too far"});
  journal_.AddEvent({4.0, "2026-11-01T02:00:00.000Z", 2, "load", "alarm", "drive_fault", "again"});
  const auto read = journal_.Alarms(kOpenAlone_s);
  Reopen();
  const auto moved = journal_.Alarms(kOpenAlone_s);
  for (const auto& open : {read, moved}) {
    ASSERT_EQ(open.size(), 2U);
    EXPECT_EQ(open[0].number, 1);
    EXPECT_EQ(open[0].code, "twist_limit");
    EXPECT_EQ(open[0].text, "too far");
    EXPECT_EQ(open[0].raised_utc, "2026-11-01T01:00:00.000Z");
    EXPECT_EQ(open[1].number, 2);
  }
  EXPECT_EQ(Ask(2, AlarmEvent::kAcknowledge).state, AlarmInstanceState::kAcknowledged);
}

TEST_F(CampaignAlarms, RefuseWhatCannotBeAndSayWhatCan) {
  EXPECT_EQ(Refusal(1, AlarmEvent::kAcknowledge),
            ": error: there is no alarm 1 (expected none: the campaign has had no alarm)");
  RaiseAt(100.0);
  EXPECT_EQ(Refusal(2, AlarmEvent::kAcknowledge),
            ": error: there is no alarm 2 (expected a number from 1 to 1)");
  EXPECT_EQ(
      Refusal(1, AlarmEvent::kConfirm),
      ": error: alarm 1 cannot be confirmed: it is unacknowledged (expected one that is latched: returned "
      "and acknowledged)");
  EXPECT_EQ(
      Refusal(1, AlarmEvent::kUnshelve),
      ": error: alarm 1 cannot be taken off its shelf: it is unacknowledged (expected one that is shelved)");
  EXPECT_EQ(Refusal(1, AlarmEvent::kShelve, 90'000.0),
            "error: an alarm cannot be shelved for 90000 s (expected more than 0 s and at most 24 h)");
  EXPECT_EQ(Refusal(1, AlarmEvent::kShelve, 0.0),
            "error: an alarm cannot be shelved for 0 s (expected more than 0 s and at most 24 h)");
  Ask(1, AlarmEvent::kAcknowledge);
  EXPECT_EQ(Refusal(1, AlarmEvent::kAcknowledge),
            ": error: alarm 1 cannot be acknowledged: it is acknowledged (expected one that nobody has "
            "acknowledged)");
  Ask(1, AlarmEvent::kShelve, kMorning, 60.0);
  EXPECT_EQ(
      Refusal(1, AlarmEvent::kShelve, 60.0),
      ": error: alarm 1 cannot be shelved: it is shelved, acknowledged (expected one that is open and on no "
      "shelf)");
  EXPECT_EQ(journal_.AlarmActions().size(), 2U) << "what was refused has left nothing";
}

TEST_F(CampaignAlarms, HaveEveryFaultAsAKind) {
  for (int i = 0; i <= static_cast<int>(StopCause::kShutdownRequested); ++i) {
    const auto cause = static_cast<StopCause>(i);
    if (!IsFault(cause)) continue;
    bool known = false;
    for (const AlarmKind& kind : kAlarmKinds) known = known || kind.code == Code(cause);
    EXPECT_TRUE(known) << Code(cause);
  }
}

TEST_F(CampaignAlarms, NotesOfPeopleAreKeptAsTheyWereWritten) {
  journal_.AddOperatorNote({"2026-11-02T10:00:00.000Z", "A. Meier", "<b>grease</b>\n\x1b[31m changed"});
  journal_.AddOperatorNote({"2026-11-02T11:00:00.000Z", "B. Kurz", "second"});
  Reopen();
  const auto notes = journal_.OperatorNotes(5);
  ASSERT_EQ(notes.size(), 2U);
  EXPECT_EQ(notes[0].author, "B. Kurz");
  EXPECT_EQ(notes[1].text, "<b>grease</b>\n\x1b[31m changed");
  EXPECT_EQ(journal_.OperatorNotes(1).size(), 1U);
}

}  // namespace
}  // namespace strainwave::bench::campaign_alarms_test
