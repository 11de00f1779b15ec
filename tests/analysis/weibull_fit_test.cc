// SPDX-License-Identifier: Apache-2.0
#include "analysis/reliability/weibull_fit.h"

#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/analysis/ball_bearings.h"

namespace strainwave::analysis::reliability::weibull_fit_test {
namespace {

constexpr double kDigitsOfR = 1e-6;  // survreg stops at a relative change of 1e-9 of the likelihood

// `survreg(Surv(t) ~ 1)` of R 4.2.2 with survival 3.5-3; shape and scale as docs/sources.md#lawless-2003
// prints them: 2.10 and 81.9.
TEST(WeibullFit, OfBallBearingsIsThatOfSurvreg) {
  const WeibullFit fit = FitWeibull(BallBearings());
  EXPECT_NEAR(fit.shape, 2.10184686376, kDigitsOfR * 2.1);
  EXPECT_NEAR(fit.scale, 81.8745587241, kDigitsOfR * 82);
  EXPECT_NEAR(fit.log_likelihood, -113.691959088, 1e-8);
  EXPECT_NEAR(fit.log_scale_variance, 0.0110355129824, kDigitsOfR);
  EXPECT_NEAR(fit.log_shape_variance, 0.0244503171144, kDigitsOfR);
  // survreg has the logarithm of 1/shape.
  EXPECT_NEAR(fit.log_covariance, 0.00540269948614, kDigitsOfR);
}

// `survreg(Surv(lo, up, type = "interval2") ~ 1, weights = w)`.
TEST(WeibullFit, OfEveryKindOfCensoringIsThatOfSurvreg) {
  std::vector<Lifetime> lives{Lifetime::FailedBefore(80),
                              Lifetime::Failed(100),
                              Lifetime::FailedBetween(200, 260),
                              Lifetime::Failed(300),
                              Lifetime::FailedBetween(300, 420),
                              Lifetime::Failed(500),
                              {800, kNever, 2.0},
                              Lifetime::Suspended(800)};
  const WeibullFit fit = FitWeibull(lives);
  EXPECT_NEAR(fit.shape, 0.897522434848, kDigitsOfR);
  EXPECT_NEAR(fit.scale, 667.266041834, kDigitsOfR * 667);
  EXPECT_NEAR(fit.log_likelihood, -31.601743297938, 1e-8);
  EXPECT_NEAR(fit.log_scale_variance, 0.2134888296320, kDigitsOfR);
  EXPECT_NEAR(fit.log_shape_variance, 0.1537445376078, kDigitsOfR);
  EXPECT_NEAR(fit.log_covariance, -0.0314119930031, kDigitsOfR);
  EXPECT_EQ(fit.counts.units, 9.0);
  EXPECT_EQ(fit.counts.failures, 6.0);
}

TEST(WeibullFit, OfOneFailureAndFourSuspensionsIsThatOfSurvreg) {
  const WeibullFit fit = FitWeibull(std::vector<Lifetime>{Lifetime::Failed(100), Lifetime::Suspended(150),
                                                          Lifetime::Suspended(200), Lifetime::Suspended(250),
                                                          Lifetime::Suspended(300)});
  EXPECT_NEAR(fit.shape, 1.26835184716, kDigitsOfR * 10);
  EXPECT_NEAR(fit.scale, 723.59845499646, kDigitsOfR * 7230);
  EXPECT_NEAR(fit.log_likelihood, -7.87760445163, 1e-8);
}

TEST(WeibullFit, OfTimesFromOneToABillionIsThatOfSurvreg) {
  const WeibullFit fit = FitWeibull(std::vector<Lifetime>{Lifetime::Failed(1), Lifetime::Failed(1e2),
                                                          Lifetime::Failed(1e4), Lifetime::Failed(1e5),
                                                          Lifetime::Failed(1e7), Lifetime::Suspended(1e9)});
  EXPECT_NEAR(fit.shape, 0.132607981812, kDigitsOfR);
  EXPECT_NEAR(fit.scale / 2322710.59794, 1.0, kDigitsOfR * 10);
}

// A unit of time is a choice.
TEST(WeibullFit, ScalesWithTheTimes) {
  std::vector<Lifetime> scaled = BallBearings();
  for (Lifetime& life : scaled) life = Lifetime::Failed(1e12 * life.lower);
  const WeibullFit fit = FitWeibull(BallBearings());
  const WeibullFit other = FitWeibull(scaled);
  EXPECT_NEAR(other.shape, fit.shape, 1e-9);
  EXPECT_NEAR(other.scale / fit.scale, 1e12, 1e3);
}

std::string WhyNone(const std::vector<Lifetime>& lives) {
  try {
    FitWeibull(lives);
  } catch (const NoEstimate& error) {
    return std::string(error.what()) + " (expected " + error.expected() + ")";
  }
  return "an estimate";
}

TEST(WeibullFit, OfNoFailureIsNone) {
  EXPECT_EQ(WhyNone({{100, kNever, 5.0}}),
            "none of 5 units has failed: no law can be fitted (expected a shape, for Weibayes)");
}

TEST(WeibullFit, OfEqualTimesIsNone) {
  EXPECT_EQ(
      WhyNone({{100, 100, 3.0}, Lifetime::Suspended(100)}),
      "all 3 failures may lie at one time, 100, which no other unit outlived: the likelihood grows with the "
      "shape without end (expected failures at different times, or a shape, for Weibayes)");
  EXPECT_EQ(
      WhyNone({Lifetime::Failed(100), Lifetime::Suspended(50)}),
      "the only failure lies at one time, 100, which no other unit outlived: the likelihood grows with the "
      "shape without end (expected failures at different times, or a shape, for Weibayes)");
  EXPECT_EQ(
      WhyNone({Lifetime::FailedBetween(50, 100), Lifetime::FailedBetween(80, 120)}),
      "all 2 failures may lie at one time, 100, which no other unit outlived: the likelihood grows with the "
      "shape without end (expected failures at different times, or a shape, for Weibayes)");
}

// All of many at one time but one unit that went on: the shape is finite again.
TEST(WeibullFit, OfEqualTimesThatAUnitOutlivedIsFinite) {
  const WeibullFit fit = FitWeibull(std::vector<Lifetime>{{100, 100, 3.0}, Lifetime::Suspended(101)});
  EXPECT_GT(fit.shape, 10.0);
  EXPECT_TRUE(std::isfinite(fit.shape));
}

TEST(WeibullFit, RejectsTimesThatAreNone) {
  const auto why = [](Lifetime life) {
    try {
      FitWeibull(std::vector<Lifetime>{Lifetime::Failed(1), life});
    } catch (const std::invalid_argument& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_EQ(why(Lifetime::Failed(0)),
            "lifetimes[1] from 0 to 0 is no life (expected times above zero in order)");
  EXPECT_EQ(why(Lifetime::Suspended(-3)),
            "lifetimes[1] from -3 to inf is no life (expected times above zero in order)");
  EXPECT_EQ(why(Lifetime::FailedBetween(5, 2)),
            "lifetimes[1] from 5 to 2 is no life (expected times above zero in order)");
  EXPECT_EQ(why({1, 1, 0}), "lifetimes[1].count = 0 is not a positive number");
}

}  // namespace
}  // namespace strainwave::analysis::reliability::weibull_fit_test
