// SPDX-License-Identifier: Apache-2.0
#include "analysis/reliability/weibull_fit.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>
#include <Eigen/LU>

#include "analysis/arguments.h"
#include "analysis/reliability/few_failures.h"
#include "analysis/reliability/weibull_likelihood.h"

namespace strainwave::analysis::reliability {
namespace {

const double kShareAtScale = -std::expm1(-1.0);  // 63.2 % have failed at η

// Whether one time lies in every failure's interval and no unit is known to have outlived it: then the
// likelihood grows as the law gets narrower about it.
std::optional<double> TimeOfAllFailures(std::span<const Lifetime> lifetimes) {
  double after = 0.0;
  double until = kNever;
  double outlived = 0.0;
  for (const Lifetime& life : lifetimes) {
    if (life.is_failure()) {
      after = std::max(after, life.lower);
      until = std::min(until, life.upper);
    } else {
      outlived = std::max(outlived, life.lower);
    }
  }
  // A failure before a time and a unit that outlived it are apart; a failure at the time and one are not.
  if (after > until || outlived > until || (outlived == until && after < until)) return std::nullopt;
  return until;
}

Eigen::Vector2d Start(std::span<const Lifetime> lifetimes, double failures) {
  double sum = 0.0;
  double squares = 0.0;
  for (const Lifetime& life : lifetimes) {
    if (!life.is_failure()) continue;
    const double log = std::log(life.middle());
    sum += life.count * log;
    squares += life.count * log * log;
  }
  const double mean = sum / failures;
  const double deviation = std::sqrt(std::max(squares / failures - mean * mean, 0.0));
  constexpr double kOfDeviation = 0.7797;  // √6/π of the extreme value law
  const double sigma = std::clamp(kOfDeviation * deviation, 0.02, 5.0);
  // η^β = Σ t^β / r at a given shape.
  double longest = -1e300;
  for (const Lifetime& life : lifetimes) longest = std::max(longest, std::log(life.middle()));
  double total = 0.0;
  for (const Lifetime& life : lifetimes)
    total += life.count * std::exp((std::log(life.middle()) - longest) / sigma);
  return {longest + sigma * std::log(total / failures), std::log(sigma)};
}

// The maximum in the coordinates of another quantile.
struct Located {
  LogLikelihood function;
  Maximum maximum;
};

Located LocatedAt(const WeibullFit& fit, LogLikelihood function, double coordinate) {
  const Eigen::Vector2d at(coordinate, -std::log(fit.shape));
  Located located{std::move(function), {at, {}}};
  located.maximum.evaluation = located.function(at);
  return located;
}

Interval Fisher(const Maximum& maximum, Eigen::Index coordinate, double level) {
  const double variance = (-maximum.evaluation.hessian).inverse()(coordinate, coordinate);
  const double half = NormalQuantile(0.5 * (1.0 + level)) * std::sqrt(variance);
  return {maximum.at(coordinate) - half, maximum.at(coordinate) + half};
}

template <class Function>
Interval Mapped(const Interval& interval, Function function) {
  const double a = function(interval.low);
  const double b = function(interval.high);
  return {std::min(a, b), std::max(a, b)};
}

bool IsCorrected(const WeibullFit& fit, const BoundsSettings& settings) {
  return fit.counts.failures >= 2.0 && fit.counts.failures <= settings.most_failures_to_correct;
}

FewFailures FewOf(const WeibullFit& fit, std::span<const Lifetime> lifetimes,
                  const BoundsSettings& settings) {
  FewFailures few = FewFailuresOf(lifetimes, fit.shape, fit.scale);
  few.simulated = settings.simulated;
  return few;
}

template <class Function>
BoundedEstimate Bounded(const Located& located, Eigen::Index coordinate, const RootMoments* moments,
                        double level, Function function) {
  BoundedEstimate bounded;
  bounded.value = function(located.maximum.at(coordinate));
  bounded.fisher = Mapped(Fisher(located.maximum, coordinate, level), function);
  bounded.likelihood_ratio =
      Mapped(LikelihoodRatioInterval(located.function, located.maximum, coordinate, level), function);
  bounded.corrected = bounded.likelihood_ratio;
  bounded.median_unbiased = bounded.value;
  if (moments == nullptr) return bounded;
  bounded.corrected = Mapped(
      LikelihoodRatioInterval(located.function, located.maximum, coordinate, level, *moments), function);
  bounded.median_unbiased =
      function(SignedRoots(located.function, located.maximum, coordinate).Solve(moments->mean));
  return bounded;
}

void RequireShare(double share_failed) {
  if (!(share_failed > 0.0 && share_failed < 1.0))
    throw std::invalid_argument(fmt::format("share_failed = {} is not between 0 and 1", share_failed));
}

}  // namespace

NoEstimate::NoEstimate(const std::string& what, std::string expected)
    : std::domain_error(what), expected_(std::move(expected)) {}

WeibullFit FitWeibull(std::span<const Lifetime> lifetimes) {
  RequireLifetimes(lifetimes);
  const LifetimeCounts counts = CountLifetimes(lifetimes);
  if (counts.failures == 0.0)
    throw NoEstimate(fmt::format("none of {:g} units has failed: no law can be fitted", counts.units),
                     "a shape, for Weibayes");
  if (const auto time = TimeOfAllFailures(lifetimes))
    throw NoEstimate(
        fmt::format("{} at one time, {:g}, which no other unit outlived: the likelihood grows with "
                    "the shape without end",
                    counts.failures == 1.0 ? std::string("the only failure lies")
                                           : fmt::format("all {:g} failures may lie", counts.failures),
                    *time),
        "failures at different times, or a shape, for Weibayes");
  const LogLikelihood function = WeibullOfQuantile(lifetimes, kShareAtScale);
  const auto maximum = Maximise(function, Start(lifetimes, counts.failures));
  if (!maximum) throw NoEstimate("the likelihood of these times has no maximum", "a shape, for Weibayes");
  WeibullFit fit;
  fit.scale = std::exp(maximum->at(0));
  fit.shape = std::exp(-maximum->at(1));
  fit.log_likelihood = maximum->evaluation.value;
  const Eigen::Matrix2d covariance = (-maximum->evaluation.hessian).inverse();
  fit.log_scale_variance = covariance(0, 0);
  fit.log_shape_variance = covariance(1, 1);
  fit.log_covariance = -covariance(0, 1);
  fit.counts = counts;
  return fit;
}

double WeibullQuantile(double shape, double scale, double share_failed) {
  RequireShare(share_failed);
  return scale * std::exp(ExtremeValueQuantile(share_failed) / shape);
}

double WeibullSurvival(double shape, double scale, double time) {
  return std::exp(-std::pow(time / scale, shape));
}

WeibullBounds BoundsOf(const WeibullFit& fit, std::span<const Lifetime> lifetimes,
                       const BoundsSettings& settings) {
  const Located located = LocatedAt(fit, WeibullOfQuantile(lifetimes, kShareAtScale), std::log(fit.scale));
  RootMoments shape;
  RootMoments scale;
  const bool corrected = IsCorrected(fit, settings);
  if (corrected) {
    shape = settings.few ? *settings.few : ShapeRoots(FewOf(fit, lifetimes, settings));
    scale = settings.few ? *settings.few : QuantileRoots(FewOf(fit, lifetimes, settings), kShareAtScale);
  }
  return {Bounded(located, 1, corrected ? &shape : nullptr, settings.level,
                  [](double lambda) { return std::exp(-lambda); }),
          Bounded(located, 0, corrected ? &scale : nullptr, settings.level,
                  [](double location) { return std::exp(location); })};
}

BoundedEstimate BoundsOfQuantile(const WeibullFit& fit, std::span<const Lifetime> lifetimes,
                                 double share_failed, const BoundsSettings& settings) {
  RequireShare(share_failed);
  const Located located = LocatedAt(fit, WeibullOfQuantile(lifetimes, share_failed),
                                    std::log(WeibullQuantile(fit.shape, fit.scale, share_failed)));
  RootMoments moments;
  const bool corrected = IsCorrected(fit, settings);
  if (corrected)
    moments = settings.few ? *settings.few : QuantileRoots(FewOf(fit, lifetimes, settings), share_failed);
  return Bounded(located, 0, corrected ? &moments : nullptr, settings.level,
                 [](double location) { return std::exp(location); });
}

BoundedEstimate BoundsOfSurvival(const WeibullFit& fit, std::span<const Lifetime> lifetimes, double time,
                                 const BoundsSettings& settings) {
  RequirePositive("time", time);
  const double zeta = fit.shape * (std::log(time) - std::log(fit.scale));
  const Located located = LocatedAt(fit, WeibullOfSurvival(lifetimes, time), zeta);
  const double share_failed = -std::expm1(-std::exp(zeta));
  RootMoments moments;
  const bool corrected = IsCorrected(fit, settings) && share_failed > 1e-12 && share_failed < 1.0 - 1e-12;
  if (corrected) {
    // t is the quantile of 1 − R(t): the same root with the other sign, since ζ falls as the quantile grows.
    moments = settings.few ? *settings.few : QuantileRoots(FewOf(fit, lifetimes, settings), share_failed);
    moments.mean = -moments.mean;
  }
  return Bounded(located, 0, corrected ? &moments : nullptr, settings.level,
                 [](double z) { return std::exp(-std::exp(z)); });
}

}  // namespace strainwave::analysis::reliability
