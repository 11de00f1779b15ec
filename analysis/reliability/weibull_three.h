// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "analysis/reliability/weibull_fit.h"

namespace strainwave::analysis::reliability {

/// R(t) = exp(−((t − γ)/η)^β) from γ on, and 1 before: γ is a life that every unit reaches.
struct WeibullThreeFit {
  double shape{};
  double scale{};
  double threshold{};  // γ, from 0 to below the first failure
  double log_likelihood{};
  double gain{};  // of log-likelihood over two parameters; hardly worth a third below 1.35 (95 %)
  LifetimeCounts counts;
};

/// The largest likelihood over γ in 0 … t₁ with a shape of at least 1: below that the likelihood grows
/// without end as γ comes to the first failure t₁, which is no estimate. Source: docs/sources.md#smith-1985.
/// @throws as `FitWeibull` does; NoEstimate where the failures that γ may not pass are fewer than three.
WeibullThreeFit FitWeibullThree(std::span<const Lifetime> lifetimes);

double WeibullThreeQuantile(const WeibullThreeFit& fit, double share_failed);

/// Likelihood-ratio intervals, two-sided: the profile over the other two. Ends at 0 or at the first failure
/// are where γ may not go beyond.
struct WeibullThreeBounds {
  Interval threshold;
  Interval shape;
  Interval quantile;
};
WeibullThreeBounds BoundsOfThree(const WeibullThreeFit& fit, std::span<const Lifetime> lifetimes,
                                 double share_failed, double level);

}  // namespace strainwave::analysis::reliability
