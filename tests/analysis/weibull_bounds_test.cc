// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <functional>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "analysis/reliability/few_failures.h"
#include "analysis/reliability/weibull_fit.h"
#include "tests/analysis/ball_bearings.h"

namespace strainwave::analysis::reliability::weibull_bounds_test {
namespace {

constexpr double kChiSquared90 = 2.705543454095404;
constexpr double kNormal95 = 1.6448536269514722;
constexpr BoundsSettings kWithoutCorrection{.level = 0.9, .most_failures_to_correct = 0.0};

// Of exact and suspended lives, straight from the density.
double LogLikelihoodOf(const std::vector<Lifetime>& lives, double shape, double scale) {
  double sum = 0.0;
  for (const Lifetime& life : lives) {
    const double x = life.lower / scale;
    sum += life.count * -std::pow(x, shape);
    if (life.is_failure()) sum += life.count * std::log(shape / scale * std::pow(x, shape - 1.0));
  }
  return sum;
}

double LargestOver(double low, double high, const std::function<double(double)>& f) {
  const double golden = 0.5 * (std::sqrt(5.0) - 1.0);
  for (int i = 0; i < 120; ++i) {
    const double a = high - golden * (high - low);
    const double b = low + golden * (high - low);
    f(a) < f(b) ? low = a : high = b;
  }
  return f(0.5 * (low + high));
}

double DropOfShape(const std::vector<Lifetime>& lives, double shape) {
  return LargestOver(-1.0, 15.0,
                     [&](double log_scale) { return LogLikelihoodOf(lives, shape, std::exp(log_scale)); });
}

double DropOfB10(const std::vector<Lifetime>& lives, double b10) {
  return LargestOver(std::log(0.05), std::log(50.0), [&](double log_shape) {
    const double shape = std::exp(log_shape);
    return LogLikelihoodOf(lives, shape, b10 / std::pow(-std::log(0.9), 1.0 / shape));
  });
}

void ExpectEndsOfProfile(const std::vector<Lifetime>& lives) {
  const WeibullFit fit = FitWeibull(lives);
  const WeibullBounds bounds = BoundsOf(fit, lives, kWithoutCorrection);
  constexpr double kSlack = 1e-4;  // of twice the log-likelihood
  for (const double end : {bounds.shape.likelihood_ratio.low, bounds.shape.likelihood_ratio.high})
    EXPECT_NEAR(2.0 * (fit.log_likelihood - DropOfShape(lives, end)), kChiSquared90, kSlack) << end;
  const BoundedEstimate b10 = BoundsOfQuantile(fit, lives, 0.1, kWithoutCorrection);
  for (const double end : {b10.likelihood_ratio.low, b10.likelihood_ratio.high})
    EXPECT_NEAR(2.0 * (fit.log_likelihood - DropOfB10(lives, end)), kChiSquared90, kSlack) << end;
  EXPECT_LT(b10.likelihood_ratio.low, b10.value);
  EXPECT_GT(b10.likelihood_ratio.high, b10.value);
  // R(t) is at least 0.9 as long as t is at most B10: the bounds of one are those of the other.
  const BoundedEstimate survival = BoundsOfSurvival(fit, lives, b10.likelihood_ratio.low, kWithoutCorrection);
  EXPECT_NEAR(survival.likelihood_ratio.low, 0.9, 1e-5);
}

TEST(WeibullBounds, LieWhereTheProfileOfTheDensityDropsByChiSquared) {
  ExpectEndsOfProfile(BallBearings());
  ExpectEndsOfProfile({Lifetime::Failed(100), Lifetime::Failed(250), Lifetime::Failed(300),
                       Lifetime::Suspended(300), Lifetime::Suspended(420)});
}

// The published normal approximation of the bearings: survreg's variances, as in weibull_fit_test.cc.
TEST(WeibullBounds, OfFisherAreNormalInTheLogarithm) {
  const WeibullFit fit = FitWeibull(BallBearings());
  const WeibullBounds bounds = BoundsOf(fit, BallBearings(), kWithoutCorrection);
  EXPECT_NEAR(bounds.shape.fisher.low, 2.10184686 * std::exp(-kNormal95 * std::sqrt(0.0244503171)), 1e-5);
  EXPECT_NEAR(bounds.scale.fisher.high, 81.8745587 * std::exp(kNormal95 * std::sqrt(0.0110355130)), 1e-3);
  const double zeta = std::log(-std::log(0.9));
  const double sigma = 1.0 / fit.shape;
  const double variance = fit.log_scale_variance + zeta * zeta * sigma * sigma * fit.log_shape_variance -
                          2.0 * zeta * sigma * fit.log_covariance;
  const BoundedEstimate b10 = BoundsOfQuantile(fit, BallBearings(), 0.1, kWithoutCorrection);
  EXPECT_NEAR(b10.fisher.low, b10.value * std::exp(-kNormal95 * std::sqrt(variance)), 1e-5 * b10.value);
}

TEST(WeibullBounds, NeverLeaveWhatCanBe) {
  const std::vector<Lifetime> lives{Lifetime::Failed(1), Lifetime::Failed(1e4), Lifetime::Failed(1e9)};
  const WeibullFit fit = FitWeibull(lives);
  for (const double share : {1e-6, 0.01, 0.1, 0.999}) {
    const BoundedEstimate quantile = BoundsOfQuantile(fit, lives, share, {});
    for (const Interval& interval : {quantile.fisher, quantile.likelihood_ratio, quantile.corrected}) {
      EXPECT_GE(interval.low, 0.0);
      EXPECT_GT(interval.high, interval.low);
    }
  }
  for (const double time : {1e-9, 1.0, 1e5, 1e12}) {
    const BoundedEstimate survival = BoundsOfSurvival(fit, lives, time, {});
    for (const Interval& interval : {survival.fisher, survival.likelihood_ratio, survival.corrected}) {
      EXPECT_GE(interval.low, 0.0);
      EXPECT_LE(interval.high, 1.0);
      EXPECT_GE(interval.high, interval.low);
    }
  }
}

// Simulated anew with another generator: how often the interval of B10 holds the truth. Two in three standard
// errors of a share of 400 are 3 %.
TEST(WeibullBounds, CorrectedCoverWhatTheySayAtFive) {
  constexpr int kSamples = 400;
  std::minstd_rand random(7);
  std::weibull_distribution<double> law(2.0, 1000.0);
  const double truth = 1000.0 * std::pow(-std::log(0.9), 0.5);
  const RootMoments moments = QuantileRoots({.last_failure = 5, .watched = {{5.0, kNever}}}, 0.1);
  int held = 0;
  int below = 0;
  for (int k = 0; k < kSamples; ++k) {
    std::vector<Lifetime> lives;
    for (int i = 0; i < 5; ++i) lives.push_back(Lifetime::Failed(law(random)));
    const WeibullFit fit = FitWeibull(lives);
    BoundsSettings settings;
    settings.few = moments;
    const BoundedEstimate b10 = BoundsOfQuantile(fit, lives, 0.1, settings);
    held += b10.corrected.low <= truth && truth <= b10.corrected.high;
    below += truth < b10.corrected.low;
  }
  EXPECT_NEAR(100.0 * held / kSamples, 90.0, 3.0);
  EXPECT_NEAR(100.0 * below / kSamples, 5.0, 2.5);
}

}  // namespace
}  // namespace strainwave::analysis::reliability::weibull_bounds_test
