// SPDX-License-Identifier: Apache-2.0
// What is asked wrongly of the page of all benches is the asker's error, not the server's.
#include <gtest/gtest.h>

#include "bench/central/fleet_server.h"
#include "tests/bench/central/lab.h"
#include "tests/bench/central/page_client.h"

namespace strainwave::bench::page_words_test {
namespace {

TEST(PageWords, WhatIsNoTextOrNoQuantityIsRefused) {
  if (!HasPostgres()) GTEST_SKIP() << kNoPostgres;
  Lab lab;
  WrittenCampaign campaign(lab.scratch / "campaign");
  campaign.AddCycles(1);
  lab.Forward(lab.Order(campaign.folder()));
  const FleetServer page({.conninfo = lab.postgres.Conninfo("admin")});
  const auto said = [&](const std::string& path) {
    const PageAnswer answer = Asked(page.port(), "/api/v1/" + path);
    return fmt::format("{} {}", answer.status, answer.body);
  };
  for (const auto& [name, path] : {std::pair{"find", "benches?find=%FF"},
                                   {"find", "benches?find=a%00b"},
                                   {"state", "benches?state=%C3"},
                                   {"query", "comparison?quantity=k1_Nm_per_rad&query=bench%3D%FF"},
                                   {"quantity", "comparison?quantity=%00"}}) {
    EXPECT_EQ(said(path), fmt::format("400 {{\"error\":\"{}: error: is no text (expected UTF-8 without the "
                                      "character zero)\"}}\n",
                                      name))
        << path;
  }
  EXPECT_EQ(said("comparison?quantity=k9"),
            "400 {\"error\":\"quantity: error: the server has no results of 'k9' (expected one of "
            "/api/v1/quantities)\"}\n");
  EXPECT_EQ(said("comparison").substr(0, 4), "400 ");
  EXPECT_EQ(said("comparison?quantity=k1_Nm_per_rad&query=bench%3Dnobody").substr(0, 4), "200 ");
  EXPECT_EQ(said("benches?find=%C3%A9").substr(0, 4), "200 ");
}

}  // namespace
}  // namespace strainwave::bench::page_words_test
