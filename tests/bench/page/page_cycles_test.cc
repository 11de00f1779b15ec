// SPDX-License-Identifier: Apache-2.0
#include "bench/page/cycles.h"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/daq/scratch_folder.h"

namespace strainwave::bench::page_cycles_test {
namespace {

std::string WhatIsWrong(const std::multimap<std::string, std::string>& parameters) {
  try {
    ParseCyclesQuery(parameters);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

TEST(CyclesQuery, HasDefaultsForWhatIsNotGiven) {
  const CyclesQuery query = ParseCyclesQuery({});
  EXPECT_EQ(query.from, 1);
  EXPECT_EQ(query.to, 0);
  EXPECT_EQ(query.points, 500);
  EXPECT_EQ(query.quantities,
            (std::vector<std::string>{"k1_Nm_per_rad", "k2_Nm_per_rad", "k3_Nm_per_rad", "e_max_arcmin",
                                      "e_avg_arcmin", "lost_motion_arcmin"}));
  const CyclesQuery given =
      ParseCyclesQuery({{"from", "3"}, {"to", "9"}, {"points", "2"}, {"quantities", "a,b,a"}});
  EXPECT_EQ(given, (CyclesQuery{3, 9, 2, {"a", "b"}}));
}

TEST(CyclesQuery, SaysWhatIsWrong) {
  EXPECT_EQ(WhatIsWrong({{"from", "0"}}), "from = '0' (expected a whole number from 1 to 1000000000)");
  EXPECT_EQ(WhatIsWrong({{"from", "1x"}}), "from = '1x' (expected a whole number from 1 to 1000000000)");
  EXPECT_EQ(WhatIsWrong({{"points", "5001"}}), "points = '5001' (expected a whole number from 1 to 5000)");
  EXPECT_EQ(WhatIsWrong({{"from", "5"}, {"to", "4"}}),
            "to = 4 is before from = 5 (expected the same cycle or a later one)");
  EXPECT_EQ(WhatIsWrong({{"form", "5"}}), "'form' is not known (expected from, to, points or quantities)");
  EXPECT_EQ(WhatIsWrong({{"to", "5"}, {"to", "6"}}), "to stands there twice (expected once)");
  EXPECT_EQ(WhatIsWrong({{"quantities", "a,b,c,d,e,f,g,h,i,j,k,l,m,n,o,p"}}), "") << "sixteen";
  EXPECT_NE(WhatIsWrong({{"quantities", "a,b,c,d,e,f,g,h,i,j,k,l,m,n,o,p,q"}}), "");
  EXPECT_NE(WhatIsWrong({{"quantities", std::string(65, 'a')}}), "");
  EXPECT_NE(WhatIsWrong({{"quantities", "a,"}}), "");
  EXPECT_EQ(
      WhatIsWrong({{"quantities", "k1';DROP"}}),
      "quantities (expected at most 16 names of results, separated by commas: k1_Nm_per_rad,e_max_arcmin)");
}

TEST(CycleBins, CoverTheCyclesWithNoMoreBinsThanAsked) {
  for (int cycles = 0; cycles < 40; ++cycles) {
    for (int points = 1; points < 12; ++points) {
      const CycleBins bins(5, 4 + cycles, points);
      EXPECT_LE(bins.bins().size(), static_cast<std::size_t>(points));
      if (cycles == 0) {
        EXPECT_TRUE(bins.bins().empty());
        continue;
      }
      EXPECT_EQ(bins.EndOf(bins.bins().size() - 1), 4 + cycles);
      EXPECT_EQ(bins.EndOf(0), std::min(4 + bins.width(), 4 + cycles));
    }
  }
}

// docs/bench/page.md says of it: no value is hidden.
TEST(CycleBins, KeepASpikeOfOneCycleInAHundredThousand) {
  constexpr int kCycles = 100'000;
  constexpr int kSpike = 54'321;
  CycleBins bins(1, kCycles, 600);
  for (int cycle = 1; cycle <= kCycles; ++cycle) {
    const double value = cycle == kSpike ? 7.125 : 1.0 + 1e-7 * cycle;
    bins.Add(cycle, {"e_max_arcmin", value, 0.25, cycle == kSpike ? "outlier" : ""});
  }
  ASSERT_EQ(bins.width(), 167);
  ASSERT_EQ(bins.bins().size(), 599u);
  int cycles = 0;
  for (std::size_t i = 0; i < bins.bins().size(); ++i) {
    const CycleBin& bin = bins.bins()[i];
    cycles += bin.count;
    const bool has_spike = bins.EndOf(i) >= kSpike && bins.EndOf(i) - bins.width() < kSpike;
    EXPECT_EQ(bin.max > 2.0, has_spike) << i;
    EXPECT_EQ(bin.flagged, has_spike ? 1 : 0);
    EXPECT_TRUE(!has_spike || bin.max == 7.125);
    EXPECT_DOUBLE_EQ(bin.last, 1.0 + 1e-7 * bins.EndOf(i));
    EXPECT_EQ(bin.last_standard_error, 0.25);
  }
  EXPECT_EQ(cycles, kCycles);
}

TEST(CyclesOfAJournal, AreThoseThatAreCompleteAndHaveAValue) {
  const daq::ScratchFolder scratch;
  Journal journal = Journal::Create(scratch.path() / "campaign.db");
  for (int cycle = 0; cycle <= 6; ++cycle) {
    journal.BeginCycle(cycle, cycle);
    const double value = cycle == 3 ? std::nan("") : 10.0 * cycle;
    journal.AddResults(cycle, 0, {{"a", value, cycle == 4 ? std::nan("") : 0.5, ""}, {"b", -1.0, 0.0, ""}});
    journal.AddResults(cycle, 1, {{"a", 1e9, 0.5, ""}});
    if (cycle < 6) journal.EndCycle(cycle, cycle + 1.0, "complete");
  }
  const auto answer = CyclesJson(journal, {1, 0, 2, {"a", "none"}}, {});
  EXPECT_EQ(answer["cycles_complete"], 5);
  EXPECT_EQ(answer["bin_cycles"], 3);
  EXPECT_EQ(answer["cycle"], nlohmann::json({3, 5}));
  EXPECT_EQ(answer["quantities"]["a"]["min"], nlohmann::json({10.0, 40.0}));
  EXPECT_EQ(answer["quantities"]["a"]["max"], nlohmann::json({20.0, 50.0}));
  EXPECT_EQ(answer["quantities"]["a"]["last"], nlohmann::json({20.0, 50.0}));
  EXPECT_EQ(answer["quantities"]["none"]["last"], nlohmann::json({nullptr, nullptr}));
  const auto each = CyclesJson(journal, {3, 4, 500, {"a"}}, {});
  EXPECT_EQ(each["cycle"], nlohmann::json({3, 4}));
  EXPECT_EQ(each["quantities"]["a"]["last"], nlohmann::json({nullptr, 40.0}));
  EXPECT_EQ(each["quantities"]["a"]["last_standard_error"], nlohmann::json({nullptr, nullptr}));
  EXPECT_EQ(CyclesJson(journal, {7, 0, 500, {"a"}}, {})["cycle"], nlohmann::json::array());
}

}  // namespace
}  // namespace strainwave::bench::page_cycles_test
