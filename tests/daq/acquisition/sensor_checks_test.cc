// SPDX-License-Identifier: Apache-2.0
#include "daq/acquisition/sensor_checks.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "tests/daq/scratch_folder.h"

namespace strainwave::daq::acquisition::sensor_checks_test {
namespace {

constexpr CheckLimits kShunt{.expected = 10, .allowed = 0.05, .most_noise = 0.02};

TEST(SensorCheck, PassesWithinItsLimitsAndSaysWhyNot) {
  const CheckResult good = JudgeCheck(CheckKind::kShunt, std::vector{10.04, 10.06, 10.02, 10.04}, kShunt);
  EXPECT_TRUE(good.passed);
  EXPECT_NEAR(good.mean, 10.04, 1e-12);
  EXPECT_NEAR(good.deviation, std::sqrt(8e-4 / 3), 1e-12);
  EXPECT_NEAR(good.standard_error, std::sqrt(8e-4 / 3) / 2, 1e-12);
  EXPECT_EQ(good.reason, "");
  EXPECT_EQ(JudgeCheck(CheckKind::kShunt, std::vector{10.06, 10.08}, kShunt).reason,
            "shunt check: 10.07 is further than 0.05 from 10");
  EXPECT_EQ(JudgeCheck(CheckKind::kZero, std::vector{9.94, 10.06}, kShunt).reason,
            "zero check: the values scatter by 0.08485, more than 0.02: something moves");
  EXPECT_EQ(JudgeCheck(CheckKind::kReference, std::vector<double>{10.0, NAN}, kShunt).reason,
            "reference check: a value is not a number");
  EXPECT_EQ(JudgeCheck(CheckKind::kZero, std::vector{10.0}, kShunt).reason,
            "zero check: 1 values are too few to judge");
}

TEST(CheckTrend, SaysWhenTheLimitWillBeMet) {
  // 1 mNm a day, exactly: at day 20 it is 10.02, the limit of 10.05 is 30 days off.
  std::vector<EarlierCheck> checks;
  for (const double day : {0.0, 4.0, 7.0, 13.0, 20.0}) checks.push_back({day, 10 + 0.001 * day});
  const std::optional<CheckTrend> trend = TrendOf(checks, kShunt);
  ASSERT_TRUE(trend);
  EXPECT_NEAR(trend->slope_per_day, 0.001, 1e-15);
  ASSERT_TRUE(trend->days_left);
  EXPECT_NEAR(*trend->days_left, 30, 1e-9);
  for (EarlierCheck& check : checks) check.mean = 20 - check.mean;
  EXPECT_NEAR(*TrendOf(checks, kShunt)->days_left, 30, 1e-9);
}

TEST(CheckTrend, StatesAnErrorThatHoldsAndPromisesNothingFromNoise) {
  std::mt19937_64 random(1);
  std::normal_distribution<double> noise(0, 0.004);
  int within = 0, promised = 0;
  for (int run = 0; run < 2000; ++run) {
    std::vector<EarlierCheck> sloped, level;
    for (int day = 0; day < 30; ++day) {
      sloped.push_back({static_cast<double>(day), 10 + 0.0005 * day + noise(random)});
      level.push_back({static_cast<double>(day), 10 + noise(random)});
    }
    const std::optional<CheckTrend> trend = TrendOf(sloped, kShunt);
    within += std::abs(trend->slope_per_day - 0.0005) < 2.048 * trend->slope_standard_error;  // t, 28 degrees
    promised += TrendOf(level, kShunt)->days_left.has_value();
  }
  EXPECT_NEAR(within / 2000.0, 0.95, 0.015);
  EXPECT_LT(promised / 2000.0, 0.07);
}

TEST(CheckTrend, WantsThreeResultsOfSeveralDays) {
  EXPECT_FALSE(TrendOf(std::vector<EarlierCheck>{{0, 10}, {1, 10.1}}, kShunt));
  EXPECT_FALSE(TrendOf(std::vector<EarlierCheck>{{1, 10}, {1, 10.1}, {1, 10.2}}, kShunt));
}

}  // namespace
}  // namespace strainwave::daq::acquisition::sensor_checks_test
