// SPDX-License-Identifier: Apache-2.0
#include "bench/notices/notice_view.h"

#include <gtest/gtest.h>

#include "bench/utc.h"

namespace strainwave::bench::notice_view_test {
namespace {

// 2026-11-02T10:00:00Z, an hour after the machine has started.
constexpr Moment kNow{1'793'613'600'000, 3'600'000, 7};

Moment Before(std::int64_t ago_ms) { return {kNow.utc_ms - ago_ms, kNow.since_boot_ms - ago_ms, kNow.boot}; }

CampaignSnapshot Running() {
  CampaignSnapshot snapshot;
  snapshot.view = BenchView::kRunning;
  snapshot.progress.process = 42;
  return snapshot;
}

std::optional<double> Quiet_s(const CampaignSnapshot& snapshot, const std::optional<double>& held_s = {}) {
  return NoticeViewOf(snapshot, "/first", kNow, held_s).quiet_s;
}

TEST(NoticeView, IsQuietSinceTheNewestSignOfLife) {
  CampaignSnapshot snapshot = Running();
  EXPECT_EQ(Quiet_s(snapshot), std::nullopt);
  snapshot.progress.run_begun = RunBegun{kNow.utc_ms - 90'000, 0.0, 42};
  EXPECT_EQ(Quiet_s(snapshot), 90.0);
  snapshot.progress.checkpoint_written = Before(30'000);
  EXPECT_EQ(Quiet_s(snapshot), 30.0);
  snapshot.progress.live_taken = Before(2'000);
  EXPECT_EQ(Quiet_s(snapshot), 2.0);
  EXPECT_EQ(Quiet_s(snapshot, 1.0), 1.0);
  EXPECT_EQ(Quiet_s(snapshot, 500.0), 2.0);
}

TEST(NoticeView, TakesNoSignFromTheFutureOrFromNobodysRun) {
  CampaignSnapshot snapshot = Running();
  snapshot.progress.run_begun = RunBegun{kNow.utc_ms + 60'000, 0.0, 42};
  snapshot.progress.checkpoint_written = Before(30'000);
  EXPECT_EQ(Quiet_s(snapshot), 30.0) << "UTC was set back since the run began";
  snapshot.progress.process = 0;
  EXPECT_EQ(Quiet_s(snapshot, 1.0), std::nullopt);
}

TEST(NoticeView, ReadsUtcAsAMomentOfThisMachine) {
  const Moment raised = MomentOf(UtcText(kNow.utc_ms - 1'250), kNow);
  EXPECT_EQ(raised.utc_ms, kNow.utc_ms - 1'250);
  EXPECT_EQ(raised.since_boot_ms, kNow.since_boot_ms - 1'250);
  EXPECT_EQ(raised.boot, kNow.boot);
  for (const char* text : {"2026-11-02T10:00:00.001Z", "2026-13-02T10:00:00.001Z", "", "yesterday"}) {
    EXPECT_EQ(MomentOf(text, kNow).utc_ms, kNow.utc_ms) << text;
  }
}

}  // namespace
}  // namespace strainwave::bench::notice_view_test
