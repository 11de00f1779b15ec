// SPDX-License-Identifier: Apache-2.0
#include "analysis/reliability/weibull_three.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <fmt/format.h>

#include "analysis/reliability/weibull_likelihood.h"

namespace strainwave::analysis::reliability {
namespace {

constexpr int kThresholds = 120;
constexpr double kLargestLambda = 0.0;  // ln σ at a shape of 1

std::vector<Lifetime> After(std::span<const Lifetime> lifetimes, double threshold) {
  std::vector<Lifetime> moved;
  for (const Lifetime& life : lifetimes) {
    const double lower = std::max(life.lower - threshold, 0.0);
    const double upper = life.upper - threshold;
    // A unit that was suspended before γ says nothing.
    if (life.is_failure() || lower > 0.0) moved.push_back({lower, upper, life.count});
  }
  return moved;
}

double EarliestEnd(std::span<const Lifetime> lifetimes) {
  double earliest = kNever;
  for (const Lifetime& life : lifetimes) earliest = std::min(earliest, life.upper);
  return earliest;
}

// Thresholds below `end`, closer to each other as they come to it.
std::vector<double> Thresholds(double end) {
  std::vector<double> thresholds;
  for (int i = 0; i < kThresholds; ++i) {
    const double left = std::pow(1.0 - static_cast<double>(i) / kThresholds, 2.0);
    thresholds.push_back(end * (1.0 - left));
  }
  return thresholds;
}

struct AtThreshold {
  double value{-kNever};
  double shape{};
  double scale{};
};

// Over η and β from 1 up.
AtThreshold BestAt(std::span<const Lifetime> lifetimes, double threshold) {
  const std::vector<Lifetime> moved = After(lifetimes, threshold);
  AtThreshold best;
  const LogLikelihood function = WeibullOfQuantile(moved, -std::expm1(-1.0));
  double longest = 0.0;
  for (const Lifetime& life : moved) longest = std::max(longest, life.middle());
  const Eigen::Vector2d start(std::log(longest), -0.7);
  auto maximum = Maximise(function, start);
  if (!maximum) return best;
  if (maximum->at(1) > kLargestLambda) {
    maximum = Maximise(function, Eigen::Vector2d(maximum->at(0), kLargestLambda), {1});
    if (!maximum) return best;
  }
  return {maximum->evaluation.value, std::exp(-maximum->at(1)), std::exp(maximum->at(0))};
}

// The largest of `value` over thresholds below an end, on a grid and then between its neighbours.
template <class Value>
std::pair<double, double> LargestBelow(double end, Value value) {
  const std::vector<double> grid = Thresholds(end);
  std::size_t best = 0;
  double largest = -kNever;
  for (std::size_t i = 0; i < grid.size(); ++i) {
    const double v = value(grid[i]);
    if (v > largest) {
      largest = v;
      best = i;
    }
  }
  double low = grid[best == 0 ? 0 : best - 1];
  double high = best + 1 < grid.size() ? grid[best + 1] : grid[best];
  const double golden = 0.5 * (std::sqrt(5.0) - 1.0);
  double at = grid[best];
  for (int i = 0; i < 40 && high - low > 1e-12 * end; ++i) {
    const double a = high - golden * (high - low);
    const double b = low + golden * (high - low);
    const double va = value(a);
    const double vb = value(b);
    for (const auto& [x, v] : {std::pair(a, va), std::pair(b, vb)}) {
      if (v > largest) {
        largest = v;
        at = x;
      }
    }
    va < vb ? low = a : high = b;
  }
  return {at, largest};
}

double Drop(double best, double value) { return std::sqrt(std::max(0.0, 2.0 * (best - value))); }

}  // namespace

WeibullThreeFit FitWeibullThree(std::span<const Lifetime> lifetimes) {
  const WeibullFit two = FitWeibull(lifetimes);
  if (two.counts.failures < 3.0)
    throw NoEstimate(fmt::format("{:g} failures are fewer than the three parameters", two.counts.failures),
                     "three failures at least, or two parameters");
  const auto [threshold, value] =
      LargestBelow(EarliestEnd(lifetimes), [&](double at) { return BestAt(lifetimes, at).value; });
  WeibullThreeFit fit;
  fit.counts = two.counts;
  if (!(value > two.log_likelihood)) {
    fit.shape = two.shape;
    fit.scale = two.scale;
    fit.log_likelihood = two.log_likelihood;
    return fit;
  }
  const AtThreshold best = BestAt(lifetimes, threshold);
  fit.shape = best.shape;
  fit.scale = best.scale;
  fit.threshold = threshold;
  fit.log_likelihood = value;
  fit.gain = value - two.log_likelihood;
  return fit;
}

double WeibullThreeQuantile(const WeibullThreeFit& fit, double share_failed) {
  return fit.threshold + WeibullQuantile(fit.shape, fit.scale, share_failed);
}

WeibullThreeBounds BoundsOfThree(const WeibullThreeFit& fit, std::span<const Lifetime> lifetimes,
                                 double share_failed, double level) {
  const double z = NormalQuantile(0.5 * (1.0 + level));
  const double end = EarliestEnd(lifetimes);
  WeibullThreeBounds bounds;
  // Along γ: the first grid points on either side that fall below, and between them by halves.
  const auto root_of_threshold = [&](double at) {
    return Drop(fit.log_likelihood, BestAt(lifetimes, at).value);
  };
  const auto end_of = [&](double outside) {
    double inside = fit.threshold;
    if (root_of_threshold(outside) < z) return outside;
    for (int i = 0; i < 40; ++i) {
      const double middle = 0.5 * (inside + outside);
      (root_of_threshold(middle) < z ? inside : outside) = middle;
    }
    return 0.5 * (inside + outside);
  };
  bounds.threshold = {end_of(0.0), end_of(end * (1.0 - 1e-6))};
  const auto signed_by = [&](double estimate, auto largest) {
    return [&, estimate, largest](double psi) -> std::optional<double> {
      return std::copysign(Drop(fit.log_likelihood, largest(psi)), estimate - psi);
    };
  };
  const auto of_quantile = [&](double log_quantile) {
    const double quantile = std::exp(log_quantile);
    return LargestBelow(std::min(end, quantile),
                        [&](double threshold) {
                          const LogLikelihood function =
                              WeibullOfQuantile(After(lifetimes, threshold), share_failed);
                          const double at = std::log(quantile - threshold);
                          auto best = Maximise(function, Eigen::Vector2d(at, -0.7), {0});
                          if (best && best->at(1) > kLargestLambda)
                            return function(Eigen::Vector2d(at, kLargestLambda)).value;
                          return best ? best->evaluation.value : -kNever;
                        })
        .second;
  };
  const auto of_shape = [&](double lambda) {
    if (lambda > kLargestLambda) return -kNever;
    return LargestBelow(end,
                        [&](double threshold) {
                          const LogLikelihood function =
                              WeibullOfQuantile(After(lifetimes, threshold), -std::expm1(-1.0));
                          const auto best =
                              Maximise(function, Eigen::Vector2d(std::log(fit.scale), lambda), {1});
                          return best ? best->evaluation.value : -kNever;
                        })
        .second;
  };
  const double log_quantile = std::log(WeibullThreeQuantile(fit, share_failed));
  const auto quantile_root = signed_by(log_quantile, of_quantile);
  bounds.quantile = {std::exp(SolveRoot(quantile_root, log_quantile, 0.2, z)),
                     std::exp(SolveRoot(quantile_root, log_quantile, 0.2, -z))};
  const double lambda = -std::log(fit.shape);
  const auto shape_root = signed_by(lambda, of_shape);
  bounds.shape = {std::max(1.0, std::exp(-SolveRoot(shape_root, lambda, 0.2, -z))),
                  std::exp(-SolveRoot(shape_root, lambda, 0.2, z))};
  return bounds;
}

}  // namespace strainwave::analysis::reliability
