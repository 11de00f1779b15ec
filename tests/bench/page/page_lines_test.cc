// SPDX-License-Identifier: Apache-2.0
#include "bench/page/trend_lines.h"

#include <cmath>

#include <gtest/gtest.h>

#include "analysis/units.h"
#include "tests/daq/scratch_folder.h"

namespace strainwave::bench::page_lines_test {
namespace {

constexpr const char* kK2 = "k2_Nm_per_rad";
constexpr const char* kEMax = "e_max_arcmin";

// K2 goes up and down by one from cycle to cycle; so do all its moving ranges.
double K2Of(int cycle) { return cycle % 2 == 0 ? 101.0 : 100.0; }

Journal JournalOf(const daq::ScratchFolder& scratch, int cycles, int flagged) {
  Journal journal = Journal::Create(scratch.path() / "campaign.db");
  for (int cycle = 0; cycle <= cycles; ++cycle) {
    journal.BeginCycle(cycle, cycle);
    const bool is_bad = cycle > 0 && cycle <= flagged;
    // What comes after the first cycles wears, and moves no limit.
    const double value = is_bad ? 9999.0 : cycle > 40 ? 50.0 : K2Of(cycle);
    journal.AddResults(cycle, 0, {{kK2, value, 0.1, is_bad ? "the loop did not close" : ""}});
    journal.EndCycle(cycle, cycle + 1.0, "complete");
  }
  return journal;
}

TEST(BaselineLimits, AreOfTheFirstSoundCyclesAndNoOthers) {
  const daq::ScratchFolder scratch;
  const Journal journal = JournalOf(scratch, 300, 3);
  const auto limits = BaselineLimitsOf(journal, std::vector<std::string>{kK2, "none"});
  ASSERT_EQ(limits.size(), 1U);
  const BaselineLimits& k2 = limits.at(kK2);
  EXPECT_EQ(k2.first_cycle, 4);
  EXPECT_EQ(k2.last_cycle, 23);
  EXPECT_EQ(k2.cycles, 20);
  EXPECT_DOUBLE_EQ(k2.limits.centre, 100.5);
  EXPECT_NEAR(k2.limits.upper - k2.limits.centre, 2.66, 5e-4);
  EXPECT_NEAR(k2.limits.centre - k2.limits.lower, 2.66, 5e-4);
}

TEST(BaselineLimits, AreFoundHoweverLateTheFirstSoundCycleIs) {
  const daq::ScratchFolder scratch;
  const Journal journal = JournalOf(scratch, 290, 270);
  const auto limits = BaselineLimitsOf(journal, std::vector<std::string>{kK2});
  EXPECT_EQ(limits.at(kK2).first_cycle, 271);
  EXPECT_EQ(limits.at(kK2).last_cycle, 290);
}

TEST(BaselineLimits, WantTenCycles) {
  const daq::ScratchFolder few;
  EXPECT_TRUE(BaselineLimitsOf(JournalOf(few, 9, 0), std::vector<std::string>{kK2}).empty());
  const daq::ScratchFolder enough;
  const auto limits = BaselineLimitsOf(JournalOf(enough, 10, 0), std::vector<std::string>{kK2});
  EXPECT_EQ(limits.at(kK2).cycles, 10);
}

TEST(TrendLines, SayWhereTheScheduleEndsTheCampaign) {
  const daq::ScratchFolder scratch;
  const Journal journal = JournalOf(scratch, 12, 0);
  schedules::StopCriteria stop;
  stop.k2_below_share_of_first = 0.5;
  stop.e_max_above_rad = RadFromArcmin(1.25);
  stop.vibration_rms_above_m_per_s2 = 8.0;
  const std::vector<std::string> asked{kK2, kEMax, "vibration_rms_accel_x_m_per_s2", "k1_Nm_per_rad"};
  const auto lines = TrendLinesJson(journal, stop, asked);
  EXPECT_EQ(lines[kK2]["stop"], nlohmann::json({{"below", 50.0}}));
  EXPECT_NEAR(lines[kEMax]["stop"]["above"].get<double>(), 1.25, 1e-12);
  EXPECT_EQ(lines["vibration_rms_accel_x_m_per_s2"]["stop"], nlohmann::json({{"above", 8.0}}));
  EXPECT_TRUE(lines["k1_Nm_per_rad"]["stop"].is_null());
  EXPECT_TRUE(lines["k1_Nm_per_rad"]["control"].is_null());
  EXPECT_EQ(lines[kK2]["control"]["cycles"], 12);
  EXPECT_EQ(lines[kK2]["control"]["centre"], 100.5);
  EXPECT_TRUE(TrendLinesJson(journal, {}, asked)[kK2]["stop"].is_null());
}

// By hand: 100 at first and 0.1 less each cycle, so that 90 % of the first value, of cycle 1, is met at cycle
// 101.
TEST(TrendLines, ForecastWhenTheScheduleEndsTheCampaign) {
  const daq::ScratchFolder scratch;
  Journal journal = Journal::Create(scratch.path() / "campaign.db");
  for (int cycle = 0; cycle <= 60; ++cycle) {
    journal.BeginCycle(cycle, cycle);
    const double wobble = cycle % 2 == 0 ? 0.02 : -0.02;
    journal.AddResults(cycle, 0, {{kK2, 100.0 - 0.1 * cycle + wobble, 0.1, ""}});
    journal.EndCycle(cycle, cycle + 1.0, "complete");
  }
  schedules::StopCriteria stop;
  stop.k2_below_share_of_first = 0.9;
  const std::vector<std::string> asked{kK2, kEMax};
  const auto lines = TrendLinesJson(journal, stop, asked);
  const auto& forecast = lines[kK2]["forecast"];
  EXPECT_NEAR(forecast["cycle"].get<double>(), 101.0, 10.0);
  EXPECT_LT(forecast["low"].get<double>(), 101.0);
  EXPECT_GT(forecast["high"].get<double>(), 101.0);
  EXPECT_EQ(forecast["level"], 0.95);
  EXPECT_TRUE(lines[kEMax]["forecast"].is_null());
  EXPECT_TRUE(TrendLinesJson(journal, {}, asked)[kK2]["forecast"].is_null());
}

}  // namespace
}  // namespace strainwave::bench::page_lines_test
