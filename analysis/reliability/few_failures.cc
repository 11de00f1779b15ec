// SPDX-License-Identifier: Apache-2.0
#include "analysis/reliability/few_failures.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <random>
#include <vector>

#include "analysis/reliability/weibull_likelihood.h"

namespace strainwave::analysis::reliability {
namespace {

constexpr unsigned kSeed = 20260;

double UnitExponential(std::mt19937_64& random) {
  // From the generator's bits alone, so that every library gives the same.
  return -std::log((static_cast<double>(random() >> 11) + 0.5) * 0x1p-53);
}

// The smallest of n unit exponentials in turn, by their spacings.
std::vector<Lifetime> FirstToFail(double units, int failures, std::mt19937_64& random) {
  std::vector<Lifetime> lives;
  double time = 0.0;
  for (int i = 0; i < failures; ++i) {
    time += UnitExponential(random) / (units - i);
    lives.push_back(Lifetime::Failed(time));
  }
  if (units > failures) lives.push_back({time, kNever, units - failures});
  return lives;
}

std::vector<Lifetime> SampleOf(const FewFailures& of, std::mt19937_64& random) {
  if (of.last_failure > 0) {
    double units = 0.0;
    for (const Watched& watched : of.watched) units += watched.units;
    return FirstToFail(units, of.last_failure, random);
  }
  std::vector<Lifetime> lives;
  for (const Watched& watched : of.watched) {
    double suspended = 0.0;
    for (double i = 0.0; i < watched.units; ++i) {
      const double life = UnitExponential(random);
      if (life <= watched.until_hazard)
        lives.push_back(Lifetime::Failed(life));
      else
        ++suspended;
    }
    if (suspended > 0.0) lives.push_back({watched.until_hazard, kNever, suspended});
  }
  return lives;
}

// Of one sample, whose truth is η = 1 and σ = 1; nothing where it says nothing of the coordinate.
std::optional<double> RootAtTruth(const std::vector<Lifetime>& lives, double share_failed,
                                  Eigen::Index coordinate) {
  const double zeta = ExtremeValueQuantile(share_failed);
  const bool is_quantile = coordinate == 0;
  const double failures = CountLifetimes(lives).failures;
  if (failures == 0.0) {
    // The longer the better, without end; at the truth, the shape that lets most of them last.
    if (!is_quantile) return std::nullopt;
    double hazards = 0.0;
    for (const Lifetime& life : lives)
      hazards += life.lower > std::exp(zeta) ? life.count * std::exp(zeta) : 0.0;
    return std::sqrt(2.0 * hazards);
  }
  const LogLikelihood function = WeibullOfQuantile(lives, share_failed);
  const auto maximum = Maximise(function, Eigen::Vector2d(zeta, 0.0));
  if (!maximum) return std::nullopt;
  return SignedRoots(function, *maximum, coordinate).At(is_quantile ? zeta : 0.0);
}

RootMoments MomentsOf(const FewFailures& of, double share_failed, Eigen::Index coordinate) {
  std::mt19937_64 random(kSeed);
  double sum = 0.0;
  double squares = 0.0;
  int taken = 0;
  for (int k = 0; k < of.simulated; ++k) {
    const std::optional<double> root = RootAtTruth(SampleOf(of, random), share_failed, coordinate);
    if (!root) continue;
    sum += *root;
    squares += *root * *root;
    ++taken;
  }
  if (taken < 2) return {};
  const double mean = sum / taken;
  return {mean, std::sqrt((squares - taken * mean * mean) / (taken - 1))};
}

}  // namespace

FewFailures FewFailuresOf(std::span<const Lifetime> lifetimes, double shape, double scale) {
  constexpr double kMostToDraw = 2000.0;  // units in a simulated sample
  const LifetimeCounts counts = CountLifetimes(lifetimes);
  double last_failure = 0.0;
  double last_suspended = 0.0;
  for (const Lifetime& life : lifetimes) {
    double& last = life.is_failure() ? last_failure : last_suspended;
    last = std::max(last, life.is_failure() ? life.upper : life.lower);
  }
  FewFailures few;
  if (last_suspended <= last_failure || counts.units > kMostToDraw) {
    few.last_failure = static_cast<int>(std::lround(counts.failures));
    few.watched.push_back({counts.units, kNever});
    return few;
  }
  const auto hazard = [&](double time) { return std::pow(time / scale, shape); };
  few.watched.push_back({counts.failures, hazard(last_suspended)});
  for (const Lifetime& life : lifetimes) {
    if (!life.is_failure()) few.watched.push_back({life.count, hazard(life.lower)});
  }
  return few;
}

RootMoments QuantileRoots(const FewFailures& of, double share_failed) {
  return MomentsOf(of, share_failed, 0);
}

RootMoments ShapeRoots(const FewFailures& of) {
  constexpr double kAny = 0.5;  // the shape is no quantile
  return MomentsOf(of, kAny, 1);
}

}  // namespace strainwave::analysis::reliability
