// SPDX-License-Identifier: Apache-2.0
// Whoever asks the page of all benches has an answer, whatever the server does.
#include <gtest/gtest.h>

#include "bench/central/away_server.h"
#include "bench/central/fleet_server.h"
#include "tests/bench/central/lab.h"
#include "tests/bench/central/page_client.h"
#include "tests/bench/central/silent_server.h"

namespace strainwave::bench::page_away_test {
namespace {

using std::chrono::milliseconds, std::chrono::hours;

TEST(PageAway, AnswersAllThoughTheServerSaysNothing) {
  SilentServer silent;
  // One attempt lasts as long as the test does.
  const FleetServer page({.conninfo = silent.Conninfo(),
                          .answer_within = milliseconds(100),
                          .patience = {.to_connect = hours(1), .to_answer = hours(1)}});
  for (const std::string path : {"/api/v1/benches", "/api/v1/benches?find=x", "/api/v1/quantities"}) {
    const PageAnswer answer = Asked(page.port(), path);
    EXPECT_EQ(answer.status, 503) << path;
    EXPECT_NE(
        answer.body.find("no answer for 0.1 s (expected one in time; it is waited for, and asked again)"),
        std::string::npos)
        << answer.body;
  }
  EXPECT_EQ(Asked(page.port(), "/").status, 200);
  Until([&] { return silent.connections() > 0; });
  EXPECT_EQ(silent.connections(), 1);
}

TEST(PageAway, AsksAServerThatIsAwayAgainNotForEachViewer) {
  SilentServer silent;
  const FleetServer page({.conninfo = silent.Conninfo(),
                          .answer_within = hours(1),
                          .first_wait = hours(1),
                          .patience = {.to_connect = milliseconds(100), .to_answer = hours(1)}});
  for (int viewer = 0; viewer < 5; ++viewer) {
    const PageAnswer answer = Asked(page.port(), fmt::format("/api/v1/benches?find={}", viewer));
    EXPECT_EQ(answer.status, 503);
    EXPECT_NE(answer.body.find("the server has said nothing for 0.1 s"), std::string::npos) << answer.body;
  }
  EXPECT_EQ(silent.connections(), 1);
}

TEST(PageAway, ASlowServerHoldsUpNobodyAndIsAskedAgain) {
  if (!HasPostgres()) GTEST_SKIP() << kNoPostgres;
  Lab lab;
  Server admin(lab.postgres.Conninfo("admin"));
  const FleetServer page({.conninfo = lab.postgres.Conninfo("admin"),
                          .answer_within = milliseconds(200),
                          .first_wait = milliseconds(1),
                          .patience = {.to_connect = hours(1), .to_answer = hours(1)}});
  Until([&] { return Asked(page.port(), "/api/v1/benches").status == 200; });
  admin.Execute("BEGIN; LOCK TABLE strainwave.benches IN ACCESS EXCLUSIVE MODE");
  EXPECT_EQ(Asked(page.port(), "/api/v1/benches?find=a").status, 503);
  // Of tables that nobody holds, but behind the one that waits.
  EXPECT_EQ(Asked(page.port(), "/api/v1/quantities").status, 503);
  admin.Execute("COMMIT");
  Until([&] { return Asked(page.port(), "/api/v1/quantities").status == 200; });
}

TEST(PageAway, WaitsLongerEachTimeAndOneAsksAtATime) {
  AwayServer away(milliseconds(1000));
  const AwayServer::Time start{};
  EXPECT_EQ(away.WhyNot(start), std::nullopt);
  away.Ask();
  EXPECT_EQ(away.WhyNot(start), std::nullopt);  // it may only be slow
  away.Overdue("late");
  EXPECT_EQ(away.WhyNot(start + hours(1)), "late");
  away.Failed("gone", start);
  EXPECT_EQ(away.WhyNot(start + milliseconds(1999)), "gone");
  EXPECT_EQ(away.WhyNot(start + milliseconds(2000)), std::nullopt);
  away.Ask();
  EXPECT_EQ(away.WhyNot(start + milliseconds(2000)), "gone");
  for (int more = 0; more < 100; ++more) away.Failed("gone", start);
  EXPECT_EQ(away.WhyNot(start + milliseconds(14'999)), "gone");
  EXPECT_EQ(away.WhyNot(start + milliseconds(15'000)), std::nullopt);
  away.Answered();
  away.Overdue("late");
  EXPECT_EQ(away.WhyNot(start), std::nullopt);
}

}  // namespace
}  // namespace strainwave::bench::page_away_test
