// SPDX-License-Identifier: Apache-2.0
#include "bench/page/page_state.h"

#include <gtest/gtest.h>

namespace strainwave::bench::page_state_test {
namespace {

CampaignProgress Progress(int process, int complete) {
  CampaignProgress progress;
  progress.process = process;
  progress.complete = complete;
  progress.cycles = 12;
  progress.cycle = complete + 1;
  progress.phase = "load_run";
  return progress;
}

Event Line(const char* severity, const char* code, const char* text) {
  return {1.0, "2026-11-29T12:00:00.000Z", 5, "", severity, code, text, 9};
}

TEST(PageView, IsOfTheJournalsLastWords) {
  EXPECT_EQ(ViewOf(Progress(42, 4), true), BenchView::kRunning);
  EXPECT_EQ(ViewOf(Progress(0, 0), false), BenchView::kNotBegun);
  EXPECT_EQ(ViewOf(Progress(0, 12), true), BenchView::kComplete);
  for (const char* ending : {"pause", "quick_stop", "quick_stop_key", "shutdown", "finish_cycle"}) {
    CampaignProgress asked = Progress(0, 4);
    asked.last_of_bench = Line("info", ending, "ended");
    EXPECT_EQ(ViewOf(asked, true), BenchView::kStopped) << ending;
  }
  CampaignProgress killed = Progress(0, 4);
  killed.last_of_bench = Line("info", "load_check", "the load is right");
  EXPECT_EQ(ViewOf(killed, true), BenchView::kInterrupted);
  CampaignProgress tripped = Progress(0, 4);
  tripped.events = {Line("info", "vibration_limit", "followed"),
                    Line("alarm", "output_torque_limit", "torque")};
  tripped.alarms = {tripped.events[1]};
  EXPECT_EQ(ViewOf(tripped, true), BenchView::kFaulted);
  CampaignProgress worn = Progress(0, 4);
  worn.alarms = {Line("alarm", "stop_criterion", "K2 has fallen")};
  EXPECT_EQ(ViewOf(worn, true), BenchView::kStopped);
}

TEST(PageView, CallsABenchSafeOnlyWhereThatIsKnown) {
  EXPECT_EQ(IsSafe(BenchView::kRunning), std::optional(false));
  EXPECT_EQ(IsSafe(BenchView::kStopped), std::optional(true));
  EXPECT_EQ(IsSafe(BenchView::kFaulted), std::optional(true));
  EXPECT_EQ(IsSafe(BenchView::kInterrupted), std::nullopt);
  EXPECT_EQ(IsSafe(BenchView::kUnreadable), std::nullopt);
}

TEST(PageSentence, NamesTheFirstOfTheAlarms) {
  CampaignSnapshot snapshot;
  snapshot.view = BenchView::kFaulted;
  // Newest first, as the journal gives them.
  snapshot.progress.alarms = {Line("alarm", "b", "the second"), Line("alarm", "a", "the first")};
  EXPECT_EQ(Sentence(snapshot), "the first; torque off, brakes on");
  snapshot.view = BenchView::kRunning;
  snapshot.progress = Progress(42, 4);
  EXPECT_EQ(Sentence(snapshot), "cycle 5 of 12, load_run");
}

TEST(PageRunId, ChangesWithEachRunOfACampaign) {
  EXPECT_EQ(RunId(0xabc, ParseRunBegun("1772366400250 12.500 77"), 77), "0000000000000abc-1772366400250");
  EXPECT_EQ(RunId(0xabc, ParseRunBegun("1772366400250 12.500 77"), 0), "0000000000000abc-1772366400250");
  // Resumed, and not begun yet.
  EXPECT_EQ(RunId(0xabc, ParseRunBegun("1772366400250 12.500 77"), 78), "0000000000000abc-of-78");
  EXPECT_EQ(RunId(0xabc, ParseRunBegun("1772366400250 12.500"), 78), "0000000000000abc-1772366400250");
  EXPECT_EQ(RunId(0xabc, std::nullopt, 0), "0000000000000abc-0");
}

TEST(PageState, GivesEveryValueItsAgeAtTheMoment) {
  CampaignSnapshot snapshot;
  snapshot.view = BenchView::kRunning;
  snapshot.progress = Progress(42, 4);
  snapshot.progress.planned_s = 1000.0;
  snapshot.progress.remaining_s = 600.0;
  snapshot.progress.pace = 20.0;
  const Moment taken{1'000'000, 50'000, 7};
  snapshot.progress.live_taken = taken;
  snapshot.progress.checkpoint_written = Moment{999'000, 49'000, 7};
  snapshot.progress.live = {{"output torque", 39.5, 60.0, "Nm"},
                            {"input speed", std::nullopt, 3000.0, "rpm", "stale"}};
  // The clock was set back by an hour meanwhile; ages are of the clock that nobody can set.
  const auto state = StateJson(snapshot, {taken.utc_ms + 1500 - 3'600'000, taken.since_boot_ms + 1500, 7});
  EXPECT_EQ(state["state"], "running");
  EXPECT_EQ(state["safe"], false);
  EXPECT_EQ(state["cycle"], 5);
  EXPECT_EQ(state["cycles"], 12);
  EXPECT_DOUBLE_EQ(state["share"], 0.4);
  EXPECT_DOUBLE_EQ(state["eta_s"], 30.0);
  EXPECT_EQ(state["eta_basis"],
            "planned durations, at the pace of this run, 20 times real time, without pauses");
  EXPECT_DOUBLE_EQ(state["values"][0]["age_s"], 1.5);
  EXPECT_EQ(state["values"][0]["value"], 39.5);
  EXPECT_TRUE(state["values"][1]["value"].is_null());
  EXPECT_EQ(state["values"][1]["missing"], "stale");
  EXPECT_DOUBLE_EQ(state["ages_s"]["checkpoint"], 2.5);
}

TEST(PageState, HasNoNumberThatIsNone) {
  CampaignSnapshot snapshot;
  snapshot.progress = Progress(0, 4);
  snapshot.progress.last_results = {{"k1_Nm_per_rad", std::nan(""), std::nan(""), "no loop"}};
  const auto state = StateJson(snapshot, {});
  EXPECT_TRUE(state["results"]["k1_Nm_per_rad"]["value"].is_null());
  EXPECT_TRUE(state["expected_end_utc"].is_null());
  EXPECT_TRUE(state["ages_s"]["readings"].is_null());
  EXPECT_TRUE(state["disk"].is_null());
}

}  // namespace
}  // namespace strainwave::bench::page_state_test
