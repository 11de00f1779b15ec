// SPDX-License-Identifier: Apache-2.0
#include "analysis/repeatability.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/analysis/chance.h"
#include "tests/analysis/message_of.h"

namespace strainwave::analysis::repeatability_test {
namespace {

TEST(EstimateRepeatability, IsTheSpreadOfOneGroupByHand) {
  const Repeatability gauge = EstimateRepeatability(std::vector<double>{10.0, 12.0, 14.0});
  EXPECT_DOUBLE_EQ(gauge.mean, 12.0);
  EXPECT_DOUBLE_EQ(gauge.repeatability_sd, 2.0);
  EXPECT_DOUBLE_EQ(gauge.reproducibility_sd, 0.0);
  EXPECT_DOUBLE_EQ(gauge.degrees_of_freedom, 2.0);
  EXPECT_NEAR(gauge.limit_95, 4.302653 * std::sqrt(2.0) * 2.0, 1e-5);  // Student's t, 2 degrees, 97.5 %
}

TEST(EstimateRepeatability, SeparatesMountingsFromRepeats) {
  std::mt19937 engine(2);
  std::normal_distribution<double> normal;
  std::vector<std::vector<double>> groups;
  for (int mounting = 0; mounting < 400; ++mounting) {
    const double level = 50.0 + 3.0 * normal(engine);
    std::vector<double> repeats;
    for (int i = 0; i < 3 + mounting % 3; ++i) {
      repeats.push_back(level + 0.5 * normal(engine));
    }
    groups.push_back(repeats);
  }
  const Repeatability gauge = EstimateRepeatability(groups);
  // 400 mountings of four repeats on average, each with a mean of its own.
  EXPECT_NEAR(gauge.repeatability_sd, 0.5, kByChance * SpreadOfDeviation(400.0 * 3.0) * 0.5);
  const double between = kByChance * SpreadOfDeviation(399.0) * 3.0;
  EXPECT_NEAR(gauge.reproducibility_sd, 3.0, between);
  EXPECT_NEAR(gauge.gauge_sd, std::hypot(0.5, 3.0), between);
}

TEST(IsLargerThanGauge, IsWrongInFiveOfAHundredUnchangedPairs) {
  std::mt19937 engine(2);
  std::normal_distribution<double> normal;
  int claimed = 0;
  constexpr int kTrials = 4000;
  for (int trial = 0; trial < kTrials; ++trial) {
    std::vector<double> repeats;
    for (int i = 0; i < 6; ++i) {
      repeats.push_back(normal(engine));
    }
    const double change = normal(engine) / std::sqrt(2.0) - normal(engine) / std::sqrt(3.0);
    claimed += IsLargerThanGauge(change, EstimateRepeatability(repeats), 2, 3) ? 1 : 0;
  }
  ExpectShare(claimed, kTrials, 0.05);
}

TEST(EstimateRepeatability, RefusesValuesWithoutARepeat) {
  EXPECT_EQ(MessageOf([] { EstimateRepeatability(std::vector<double>{1.0}); }),
            "repeats: no group has two values (expected one at least)");
  EXPECT_EQ(MessageOf([] {
              IsLargerThanGauge(1.0, EstimateRepeatability(std::vector<double>{1.0, 2.0}), 0, 1);
            }),
            "count_before = 0, count_after = 1 (expected at least 1 each)");
}

}  // namespace
}  // namespace strainwave::analysis::repeatability_test
