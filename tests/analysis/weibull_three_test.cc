// SPDX-License-Identifier: Apache-2.0
#include "analysis/reliability/weibull_three.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "tests/analysis/ball_bearings.h"

namespace strainwave::analysis::reliability::weibull_three_test {
namespace {

// docs/sources.md#lawless-2003 prints threshold 14.9, scale 63.9 and shape 1.59 of these bearings.
TEST(WeibullThree, OfBallBearingsIsThePublishedOne) {
  const WeibullThreeFit fit = FitWeibullThree(BallBearings());
  EXPECT_NEAR(fit.threshold, 14.9, 0.06);
  EXPECT_NEAR(fit.scale, 63.9, 0.06);
  EXPECT_NEAR(fit.shape, 1.59, 0.006);
  EXPECT_LT(fit.gain, 1.35);
}

// A time that all units share comes back, and the two-parameter law of the rest.
TEST(WeibullThree, FindsATimeThatWasAddedToAll) {
  std::vector<Lifetime> lives;
  for (int i = 1; i <= 40; ++i)
    lives.push_back(Lifetime::Failed(500.0 + 100.0 * std::pow(-std::log1p(-i / 41.0), 0.5)));
  const WeibullThreeFit fit = FitWeibullThree(lives);
  EXPECT_NEAR(fit.threshold, 500.0, 12.0);
  EXPECT_GT(fit.gain, 1.35);
  const WeibullThreeBounds bounds = BoundsOfThree(fit, lives, 0.1, 0.9);
  EXPECT_LT(bounds.threshold.low, 500.0);
  EXPECT_GT(bounds.threshold.high, 500.0);
  EXPECT_LE(bounds.threshold.high, lives.front().lower);
  EXPECT_LT(bounds.quantile.low, WeibullThreeQuantile(fit, 0.1));
  EXPECT_GT(bounds.quantile.high, WeibullThreeQuantile(fit, 0.1));
  EXPECT_LT(bounds.shape.low, 2.0);
  EXPECT_GT(bounds.shape.high, 2.0);
}

// Below a shape of 1 the likelihood has no maximum: none is made up.
TEST(WeibullThree, StaysWithTwoParametersWhereTheShapeIsBelowOne) {
  const std::vector<Lifetime> lives{Lifetime::Failed(1), Lifetime::Failed(10), Lifetime::Failed(1000),
                                    Lifetime::Failed(50000)};
  const WeibullThreeFit fit = FitWeibullThree(lives);
  EXPECT_EQ(fit.threshold, 0.0);
  EXPECT_EQ(fit.gain, 0.0);
  EXPECT_EQ(fit.shape, FitWeibull(lives).shape);
}

TEST(WeibullThree, AsksForThreeFailures) {
  try {
    FitWeibullThree(std::vector<Lifetime>{Lifetime::Failed(1), Lifetime::Failed(2), Lifetime::Suspended(3)});
    FAIL();
  } catch (const NoEstimate& error) {
    EXPECT_STREQ(error.what(), "2 failures are fewer than the three parameters");
    EXPECT_EQ(error.expected(), "three failures at least, or two parameters");
  }
}

}  // namespace
}  // namespace strainwave::analysis::reliability::weibull_three_test
