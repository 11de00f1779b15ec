// SPDX-License-Identifier: Apache-2.0
// What the page of all benches shows and answers.
#include <gtest/gtest.h>

#include <httplib.h>
#include <nlohmann/json.hpp>

#include "bench/central/fleet_server.h"
#include "bench/central/fleet_view.h"
#include "tests/bench/central/lab.h"

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
  httplib::Client client("127.0.0.1", page.port());
  const auto start = client.Get("/");
  ASSERT_TRUE(start);
  EXPECT_EQ(start->status, 200);
  EXPECT_NE(start->body.find("All benches"), std::string::npos);
  EXPECT_EQ(start->get_header_value("Content-Security-Policy").substr(0, 18), "default-src 'none'");
  EXPECT_EQ(client.Get("/fleet.mjs")->status, 200);
  EXPECT_EQ(client.Get("/page.css")->status, 200);
  const auto listed = client.Get("/api/v1/benches?find=hall-3");
  EXPECT_EQ(nlohmann::json::parse(listed->body)["benches"][0]["bench"], "hall-3");
  EXPECT_EQ(client.Get("/api/v1/benches?from=-1")->body,
            "{\"error\":\"from: error: '-1' is no number of a row (expected 0 or more)\"}\n");
  EXPECT_EQ(nlohmann::json::parse(client.Get("/api/v1/quantities")->body)["quantities"].size(), 3U);
  EXPECT_EQ(client.Post("/api/v1/benches")->status, 405);
  EXPECT_EQ(client.Get("/page.mjs")->status, 404);
  EXPECT_EQ(client.Get("/", {{"Host", "elsewhere.example"}})->status, 403);
  lab_->postgres.Stop();
  const auto away = client.Get("/api/v1/benches?find=x");
  EXPECT_EQ(away->status, 503);
  EXPECT_NE(away->body.find("(expected a PostgreSQL server that answers there)"), std::string::npos)
      << away->body;
  lab_->postgres.Start();
  EXPECT_EQ(client.Get("/api/v1/benches?find=x")->status, 200);
}

}  // namespace
}  // namespace strainwave::bench::fleet_test
