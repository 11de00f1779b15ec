// SPDX-License-Identifier: Apache-2.0
#include "bench/campaign/quality.h"

#include <cmath>

#include <gtest/gtest.h>

#include "analysis/units.h"
#include "bench/campaign/cycle_results.h"

namespace strainwave::bench::quality_test {
namespace {

class Quality : public testing::Test {
 protected:
  Quality() : journal_(Journal::Create(":memory:")) {}

  static std::vector<Result> K2(double value, const std::string& flag = "") {
    return {{"k2_Nm_per_rad", value, 10.0, flag}};
  }

  schedules::Schedule schedule_;
  Journal journal_;
};

TEST(StopDistances, AreThoseOfTheQuantitiesThatTheCycleHas) {
  schedules::StopCriteria stop;
  stop.k2_below_share_of_first = 0.8;
  stop.e_max_above_rad = RadFromArcmin(1.2);
  const std::vector<Result> last{{"k2_Nm_per_rad", 24000.0, 10.0, ""},
                                 {"vibration_rms_x_m_per_s2", 3.0, 0.1, ""}};
  const auto distances = StopDistances(stop, 25000.0, last);
  ASSERT_EQ(distances.size(), 1U);
  EXPECT_EQ(distances[0].quantity, "K2");
  EXPECT_EQ(distances[0].value, 24000.0);
  EXPECT_DOUBLE_EQ(distances[0].limit, 20000.0);
  EXPECT_TRUE(distances[0].is_lower);
}

TEST(StopDistances, LeaveOutAVibrationWhoseSensorWasDead) {
  schedules::StopCriteria stop;
  stop.vibration_rms_above_m_per_s2 = 10.0;
  const std::vector<Result> last{
      {"vibration_rms_accel_x_m_per_s2", 123.3, 0.0, "1200 of 25600 samples stand"},
      {"vibration_rms_accel_y_m_per_s2", 0.3, 0.0, ""}};
  const auto distances = StopDistances(stop, std::nullopt, last);
  ASSERT_EQ(distances.size(), 1U);
  EXPECT_EQ(distances[0].quantity, "vibration_rms_accel_y_m_per_s2");
}

TEST(OpenAlarms, AreThoseSinceTheLastResumeHoweverLongAgo) {
  Journal journal = Journal::Create(":memory:");
  const auto note = [&](const char* severity, const char* code) {
    journal.AddEvent({0.0, "", 1, "", severity, code, ""});
  };
  note("alarm", "twist_limit");
  note("info", "resume");
  note("alarm", "output_torque_limit");
  for (int i = 0; i < 2000; ++i) note("warning", "failed_check");
  const auto alarms = journal.OpenAlarms();
  ASSERT_EQ(alarms.size(), 1U);
  EXPECT_EQ(alarms[0].code, "output_torque_limit");
}

// SQLite has no not-a-number: it keeps NULL, and would give back zero, a value that was never measured.
TEST(JournalResults, ThatAreNoNumbersComeBackAsNone) {
  Journal journal = Journal::Create(":memory:");
  const double none = std::nan("");
  journal.BeginCycle(1, 0.0);
  journal.AddResults(
      1, 0, {{"k3_Nm_per_rad", none, none, "the loop does not reach T2"}, {"k2_Nm_per_rad", 2e4, none, ""}});
  journal.EndCycle(1, 1.0, "complete");
  const std::vector<Result> results = journal.Results(1, 0);
  ASSERT_EQ(results.size(), 2U);
  EXPECT_EQ(results[0].value, 2e4);
  EXPECT_TRUE(std::isnan(results[0].standard_error));
  EXPECT_TRUE(std::isnan(results[1].value));
  EXPECT_FALSE(IsSound({"k3_Nm_per_rad", none, none, ""}));
  ASSERT_EQ(journal.NewestResults("k3_Nm_per_rad", 1).size(), 1U);
  EXPECT_TRUE(std::isnan(journal.NewestResults("k3_Nm_per_rad", 1).front().value));
  journal.ForEachResult("k3", [](const CycleResult& row) {
    EXPECT_TRUE(std::isnan(row.result.value));
    return true;
  });
}

// A slow decline with scatter of ±15 that has no memory: the fraction of a fast sine.
double Declining(int cycle) {
  const double fast = 43758.5453 * std::sin(12.9898 * cycle);
  return 25000.0 - 2.0 * cycle + 30.0 * (fast - std::floor(fast) - 0.5);
}

TEST_F(Quality, LetsASlowDeclinePass) {
  QualityControl quality(schedule_, journal_);
  for (int cycle = 1; cycle <= 200; ++cycle) {
    EXPECT_TRUE(quality.Outliers(K2(Declining(cycle))).empty()) << cycle;
    quality.Accept(cycle, K2(Declining(cycle)));
  }
}

TEST_F(Quality, WarnsOfAValueFarOffAndTakesItForAStepWhenItStays) {
  QualityControl quality(schedule_, journal_);
  for (int cycle = 1; cycle <= 40; ++cycle) quality.Accept(cycle, K2(Declining(cycle)));
  const double broken = Declining(41) - 2000.0;
  const auto outliers = quality.Outliers(K2(broken));
  ASSERT_EQ(outliers.size(), 1u);
  EXPECT_TRUE(outliers[0].starts_with("k2_Nm_per_rad = 22")) << outliers[0];
  quality.Accept(41, K2(broken));  // measured again, and still there
  for (int cycle = 42; cycle <= 80; ++cycle) {
    const double value = Declining(cycle) - 2000.0;
    EXPECT_TRUE(quality.Outliers(K2(value)).empty()) << cycle;
    quality.Accept(cycle, K2(value));
  }
}

TEST_F(Quality, DoesNotJudgeAMeasurementWhoseChecksFailed) {
  QualityControl quality(schedule_, journal_);
  for (int cycle = 1; cycle <= 40; ++cycle) quality.Accept(cycle, K2(Declining(cycle)));
  EXPECT_TRUE(quality.Outliers(K2(1000.0, "loop is not closed")).empty());
  EXPECT_FALSE(quality.Outliers(K2(1000.0, "measured at 20.0 degC, declared are 35.0 ± 7.0 degC")).empty());
}

TEST_F(Quality, IsNoStricterThanTheGauge) {
  journal_.SetCalibration({"repeatability_k2_Nm_per_rad", 500.0, 50.0, "Nm/rad", "test"}, "");
  QualityControl quality(schedule_, journal_);
  for (int cycle = 1; cycle <= 40; ++cycle) quality.Accept(cycle, K2(Declining(cycle)));
  EXPECT_TRUE(quality.Outliers(K2(Declining(41) - 2000.0)).empty());
  EXPECT_FALSE(quality.Outliers(K2(Declining(41) - 4000.0)).empty());
}

TEST_F(Quality, StopsWhenK2IsBelowItsShareOfTheFirst) {
  schedule_.stop.k2_below_share_of_first = 0.9;
  QualityControl quality(schedule_, journal_);
  quality.Accept(1, K2(25000.0));
  EXPECT_FALSE(quality.StopCriterion(K2(22501.0)));
  EXPECT_FALSE(quality.StopCriterion(K2(20000.0, "loop is not closed")));
  EXPECT_EQ(quality.StopCriterion(K2(22499.0)),
            "K2 = 22499 Nm/rad is below 22500 Nm/rad, 90 % of its first value");
}

TEST_F(Quality, StopsOnTransmissionErrorAndOnVibration) {
  schedule_.stop.e_max_above_rad = RadFromArcmin(1.5);
  schedule_.stop.vibration_rms_above_m_per_s2 = 4.0;
  const QualityControl quality(schedule_, journal_);
  EXPECT_EQ(quality.StopCriterion({{"e_max_arcmin", 1.6, 0.01, ""}}),
            "e_max = 1.60 arcmin is above 1.50 arcmin");
  EXPECT_EQ(quality.StopCriterion({{"vibration_rms_accel_x_m_per_s2", 4.5, 0.0, ""}}),
            "vibration_rms_accel_x_m_per_s2 = 4.50 m/s2 is above 4.00 m/s2");
  EXPECT_FALSE(quality.StopCriterion({{"e_max_arcmin", 1.4, 0.01, ""}}));
}

// A campaign that was cut judges as one that was not: the journal holds all it needs.
TEST_F(Quality, TakesUpWhatTheJournalHolds) {
  QualityControl whole(schedule_, journal_);
  for (int cycle = 1; cycle <= 40; ++cycle) {
    journal_.BeginCycle(cycle, cycle);
    journal_.AddResults(cycle, 0, K2(Declining(cycle)));
    journal_.EndCycle(cycle, cycle, "complete");
    whole.Accept(cycle, K2(Declining(cycle)));
  }
  const QualityControl resumed(schedule_, journal_);
  for (const double value : {Declining(41), Declining(41) - 300.0, Declining(41) + 90.0}) {
    EXPECT_EQ(resumed.Outliers(K2(value)), whole.Outliers(K2(value)));
  }
}

// Wherever it is cut: slowly falling, with steps and lone outliers, among measurements that do not count.
TEST_F(Quality, TakesUpAHistoryWithStepsWhereverItIsCut) {
  QualityControl whole(schedule_, journal_);
  double level = 0.0;
  for (int cycle = 1; cycle <= 700; ++cycle) {
    if (cycle % 90 == 0 || cycle % 90 == 7) level -= 1500.0;
    const double value = Declining(cycle) + level + (cycle % 41 == 0 ? 900.0 : 0.0);
    const auto results = K2(value, cycle % 5 == 0 ? "loop is not closed" : "");
    journal_.BeginCycle(cycle, cycle);
    journal_.AddResults(cycle, 0, results);
    journal_.EndCycle(cycle, cycle, "complete");
    whole.Accept(cycle, results);
    if (cycle % 13 != 0) continue;
    const QualityControl resumed(schedule_, journal_);
    for (const double offset : {0.0, -60.0, 60.0, -200.0, 200.0, -900.0, -1500.0}) {
      const auto next = K2(Declining(cycle + 1) + level + offset);
      EXPECT_EQ(resumed.Outliers(next), whole.Outliers(next)) << cycle;
    }
  }
}

TEST(Repeatability, IsTheSpreadOfTheRepeatsWidenedForTheirNumber) {
  std::vector<std::vector<Result>> repeats;
  for (const double value : {24990.0, 25000.0, 25010.0})
    repeats.push_back({{"k2_Nm_per_rad", value, 0.0, ""}});
  const auto gauge = RepeatabilityOf(repeats);
  ASSERT_EQ(gauge.size(), 2u);
  EXPECT_EQ(gauge[0].name, "repeatability_k2_Nm_per_rad");
  // Standard deviation 10 with two degrees of freedom: Student's t at 97.5 % is 4.303 (table) against 1.960.
  EXPECT_NEAR(gauge[0].value, 10.0 * 4.303 / 1.960, 0.01);
  EXPECT_EQ(gauge[1].name, "limit_95_k2_Nm_per_rad");
  EXPECT_NEAR(gauge[1].value, 10.0 * 4.303 * std::sqrt(2.0), 0.01);
}

TEST(Repeatability, HasTheUnitOfItsQuantity) {
  const std::vector<Result> repeat{{"k2_Nm_per_rad", 1.0, 0.0, ""},
                                   {"starting_torque_Nm", 1.0, 0.0, ""},
                                   {"efficiency_percent", 1.0, 0.0, ""},
                                   {"vibration_rms_accel_x_m_per_s2", 1.0, 0.0, ""},
                                   {"samples_received_rack", 1.0, 0.0, ""}};
  std::vector<std::string> units;
  for (const Calibration& gauge : RepeatabilityOf({repeat, repeat})) units.push_back(gauge.unit);
  EXPECT_EQ(units,
            (std::vector<std::string>{"Nm/rad", "Nm/rad", "Nm", "Nm", "%", "%", "m/s2", "m/s2", "", ""}));
}

}  // namespace
}  // namespace strainwave::bench::quality_test
