// SPDX-License-Identifier: Apache-2.0
// What the page of all benches shows and answers.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "bench/central/fleet_server.h"
#include "bench/central/fleet_view.h"
#include "tests/bench/central/lab.h"
#include "tests/bench/central/page_client.h"

namespace strainwave::bench::fleet_test {
namespace {

class Fleet : public testing::Test {
 protected:
  void SetUp() override {
    if (!HasPostgres()) GTEST_SKIP() << kNoPostgres;
    lab_ = std::make_unique<Lab>();
    campaign_ = std::make_unique<WrittenCampaign>(lab_->scratch / "campaign");
    campaign_->AddCycles(2);
    campaign_->RaiseAlarm("2026-12-01T10:00:00.000Z");
    lab_->AddBench("hall-4");
    lab_->Forward(lab_->Order(campaign_->folder()));
  }
  std::unique_ptr<Lab> lab_;
  std::unique_ptr<WrittenCampaign> campaign_;
};

TEST_F(Fleet, ListsAndComparesWhatQueriesAskFor) {
  Server admin(lab_->postgres.Conninfo("admin"));
  const auto benches = BenchesJson(admin, {.find = "HALL", .state = {}});
  EXPECT_EQ(benches["count"], 2);
  EXPECT_EQ(benches["states"]["never seen"], 1);
  EXPECT_EQ(BenchesJson(admin, {.find = {}, .state = {}})["states"], benches["states"]);
  const auto unseen = BenchesJson(admin, {.find = {}, .state = "never seen"});
  EXPECT_EQ(unseen["benches"].size(), 1U);
  EXPECT_EQ(unseen["benches"][0]["bench"], "hall-4");
  EXPECT_EQ(benches["benches"][0]["specimen"], "SIM-0001");
  EXPECT_EQ(benches["benches"][0]["complete"], 1);
  EXPECT_EQ(benches["benches"][0]["last_alarm"], "twist beyond its limit");
  EXPECT_EQ(benches["benches"][1]["bench"], "hall-4");
  EXPECT_EQ(BenchesJson(admin, {.find = "nothing", .state = {}})["count"], 0);
  const auto compared =
      ComparisonJson(admin, "k1_Nm_per_rad", ParseCampaignQuery("specimen=SIM-* bench=hall-3,x"));
  ASSERT_EQ(compared["campaigns"].size(), 1U);
  EXPECT_EQ(compared["campaigns"][0]["last"], 15001.0);
  EXPECT_EQ(ComparisonJson(admin, "k1_Nm_per_rad", ParseCampaignQuery("specimen=SIM_*"))["campaigns"].size(),
            0U);
  EXPECT_EQ(RefusalOf([] { ParseCampaignQuery("specimens=1"); }),
            "2: 'specimens=1' is no condition (expected bench=, specimen=, schedule= or campaign= with a "
            "value, such as "
            "bench=hall-* specimen=A1,A2)");
}

TEST_F(Fleet, AnswersItsOwnMachineOnly) {
  const FleetServer page({lab_->postgres.Conninfo("admin"), 0});
  const int port = page.port();
  const PageAnswer start = Asked(port, "/");
  EXPECT_EQ(start.status, 200);
  EXPECT_NE(start.body.find("All benches"), std::string::npos);
  EXPECT_NE(start.head.find("Content-Security-Policy: default-src 'none'"), std::string::npos) << start.head;
  EXPECT_EQ(Asked(port, "/fleet.mjs").status, 200);
  EXPECT_EQ(Asked(port, "/page.css").status, 200);
  const PageAnswer listed = Asked(port, "/api/v1/benches?find=hall-3");
  EXPECT_EQ(nlohmann::json::parse(listed.body)["benches"][0]["bench"], "hall-3");
  EXPECT_EQ(Asked(port, "/api/v1/benches?from=-1").body,
            "{\"error\":\"from: error: '-1' is no number of a row (expected 0 or more)\"}\n");
  EXPECT_EQ(nlohmann::json::parse(Asked(port, "/api/v1/quantities").body)["quantities"].size(), 3U);
  EXPECT_EQ(Asked(port, "/api/v1/benches", "POST").status, 405);
  EXPECT_EQ(Asked(port, "/page.mjs").status, 404);
  EXPECT_EQ(Asked(port, "/", "GET", "elsewhere.example").status, 403);
  lab_->postgres.Stop();
  const PageAnswer away = Asked(port, "/api/v1/benches?find=x");
  EXPECT_EQ(away.status, 503);
  EXPECT_NE(away.body.find("(expected a PostgreSQL server that "), std::string::npos) << away.body;
  lab_->postgres.Start();
  Until([&] { return Asked(port, "/api/v1/benches?find=x").status == 200; });
}

}  // namespace
}  // namespace strainwave::bench::fleet_test
