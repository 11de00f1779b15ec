// SPDX-License-Identifier: Apache-2.0
#include "analysis/reliability/test_plan.h"

#include <cmath>
#include <stdexcept>

#include <gtest/gtest.h>

namespace strainwave::analysis::reliability::test_plan_test {
namespace {

Demonstration NinetyNinety(int failures_allowed) {
  return {.share_failed = 0.1,
          .life = 1000.0,
          .confidence = 0.9,
          .shape = 1.7,
          .failures_allowed = failures_allowed};
}

// The well known numbers of units that show 90 % with 90 % confidence in one life: 22, 38, 52, 65
// (MIL-HDBK-189C, and any table of binomial plans).
TEST(TestPlan, AsksForTheUnitsOfTheTables) {
  EXPECT_EQ(UnitsToShow(NinetyNinety(0), 1000.0), 22);
  EXPECT_EQ(UnitsToShow(NinetyNinety(1), 1000.0), 38);
  EXPECT_EQ(UnitsToShow(NinetyNinety(2), 1000.0), 52);
  EXPECT_EQ(UnitsToShow(NinetyNinety(3), 1000.0), 65);
  EXPECT_EQ(UnitsToShow(NinetyNinety(0), 1.0, 1000), std::nullopt);
}

// ln(1 − C), not ln C: three units, 90 % confidence of B10, exponential: ln 0.1 / (3 ln 0.9) = 7.2848.
TEST(TestPlan, WithoutFailuresIsTheRuleOfSuccesses) {
  Demonstration wanted = NinetyNinety(0);
  wanted.shape = 1.0;
  EXPECT_NEAR(TestTimeToShow(wanted, 3), 7284.8, 0.1);
  wanted.shape = 2.0;
  EXPECT_NEAR(TestTimeToShow(wanted, 3), 1000.0 * std::sqrt(7.2848), 0.1);
  EXPECT_NEAR(LifeShown(wanted, 3, TestTimeToShow(wanted, 3)), 1000.0, 1e-9);
}

// Of a product that just has the life, 1 − C pass.
TEST(TestPlan, IsPassedByWhatJustHasTheLifeInOneOfTen) {
  const Demonstration wanted = NinetyNinety(2);
  EXPECT_NEAR(ChanceToPass(wanted, 9, TestTimeToShow(wanted, 9), 1000.0), 0.1, 1e-9);
  EXPECT_GT(ChanceToPass(wanted, 9, TestTimeToShow(wanted, 9), 3000.0), 0.5);
}

TEST(TestPlan, RejectsWhatCannotBe) {
  const auto why = [](Demonstration wanted, int units) {
    try {
      TestTimeToShow(wanted, units);
    } catch (const std::invalid_argument& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  Demonstration wanted = NinetyNinety(3);
  EXPECT_EQ(why(wanted, 3), "units = 3 is not more than failures_allowed = 3");
  wanted.confidence = 1.0;
  EXPECT_EQ(why(wanted, 9), "confidence = 1 is not between 0 and 1");
  wanted = NinetyNinety(0);
  wanted.shape = 0.0;
  EXPECT_EQ(why(wanted, 9), "shape = 0 is not a positive number");
}

}  // namespace
}  // namespace strainwave::analysis::reliability::test_plan_test
