// SPDX-License-Identifier: Apache-2.0
#include "analysis/reliability/acceleration.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "tests/analysis/ball_bearings.h"

namespace strainwave::analysis::reliability::acceleration_test {
namespace {

constexpr double kDigitsOfDifferences = 1e-4;
const std::vector<double> kShares{0.1};
const std::vector<std::string> kTorque{"torque"};

std::vector<StressStep> Always(double ratio) { return {{1.0, {std::log(ratio)}}}; }

// At twice the use torque an eighth of the time does the same: the two-parameter fit of eight times as long
// lives.
TEST(Acceleration, ByAKnownExponentIsALongerLife) {
  std::vector<StressedLife> lives;
  std::vector<Lifetime> longer;
  for (const Lifetime& life : BallBearings()) {
    lives.push_back({life, Always(2.0)});
    longer.push_back(Lifetime::Failed(8.0 * life.lower));
  }
  const AcceleratedFit fit = FitAccelerated(lives, {{3.0, 0.0}}, kShares, 0.9, kTorque);
  const WeibullFit two = FitWeibull(longer);
  const BoundedEstimate b10 =
      BoundsOfQuantile(two, longer, 0.1, {.level = 0.9, .most_failures_to_correct = 0.0});
  EXPECT_NEAR(fit.shape.value, two.shape, kDigitsOfDifferences);
  EXPECT_NEAR(fit.quantiles[0].value / b10.value, 1.0, kDigitsOfDifferences);
  EXPECT_NEAR(fit.quantiles[0].likelihood_ratio.low / b10.likelihood_ratio.low, 1.0, kDigitsOfDifferences);
  EXPECT_NEAR(fit.exponents[0].value, 3.0, 0.0);
}

// Equal samples at two torques whose times differ by their cube have the exponent 3 exactly.
TEST(Acceleration, FindsTheExponentThatMakesSamplesAlike) {
  std::vector<StressedLife> lives;
  for (const Lifetime& life : BallBearings()) {
    lives.push_back({life, Always(1.0)});
    lives.push_back({Lifetime::Failed(life.lower / 27.0), Always(3.0)});
  }
  const AcceleratedFit fit = FitAccelerated(lives, {{1.0, kNever}}, kShares, 0.9, kTorque);
  EXPECT_NEAR(fit.exponents[0].value, 3.0, kDigitsOfDifferences);
  EXPECT_LT(fit.exponents[0].likelihood_ratio.low, 3.0);
  EXPECT_GT(fit.exponents[0].likelihood_ratio.high, 3.0);
  EXPECT_NEAR(fit.shape.value, 2.10184686, kDigitsOfDifferences);
  EXPECT_GT(fit.quantiles[0].fisher.low, 0.0);
}

// 20 at the use torque, then twice that: what is left of a life goes eight times as fast.
TEST(Acceleration, StepsAddUpTheirDamage) {
  std::vector<StressedLife> lives;
  for (const Lifetime& life : BallBearings()) {
    const double stepped = life.lower < 20.0 ? life.lower : 20.0 + (life.lower - 20.0) / 8.0;
    lives.push_back({Lifetime::Failed(stepped), {{20.0, {0.0}}, {1e9, {std::log(2.0)}}}});
  }
  const AcceleratedFit fit = FitAccelerated(lives, {{3.0, 0.0}}, {0.1}, 0.9, kTorque);
  const WeibullFit two = FitWeibull(BallBearings());
  EXPECT_NEAR(fit.shape.value, two.shape, kDigitsOfDifferences);
  EXPECT_NEAR(fit.quantiles[0].value / WeibullQuantile(two.shape, two.scale, 0.1), 1.0, kDigitsOfDifferences);
}

// Where the torque is always the same, a prior stays what it was: normal, 3 ± 1.
TEST(Acceleration, WithoutAnotherTorqueKnowsThePriorAlone) {
  std::vector<StressedLife> lives;
  for (const Lifetime& life : BallBearings()) lives.push_back({life, Always(2.0)});
  const AcceleratedFit fit = FitAccelerated(lives, {{3.0, 1.0}}, kShares, 0.9, kTorque);
  EXPECT_NEAR(fit.exponents[0].value, 3.0, 1e-3);
  EXPECT_NEAR(fit.exponents[0].likelihood_ratio.low, 3.0 - 1.6449, 1e-2);
  EXPECT_NEAR(fit.exponents[0].likelihood_ratio.high, 3.0 + 1.6449, 1e-2);
  try {
    FitAccelerated(lives, {{3.0, kNever}}, kShares, 0.9, kTorque);
    FAIL();
  } catch (const NoEstimate& error) {
    EXPECT_STREQ(error.what(), "torque is the same in all steps of all units: its exponent cannot be fitted");
    EXPECT_EQ(error.expected(), "another torque of some units, or the catalogue's exponent");
  }
}

}  // namespace
}  // namespace strainwave::analysis::reliability::acceleration_test
