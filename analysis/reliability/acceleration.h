// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include "analysis/reliability/weibull_fit.h"

namespace strainwave::analysis::reliability {

/// A segment of a unit's test at constant stresses, up to `end` of the unit's own time.
struct StressStep {
  double end{};
  std::vector<double> log_stress;  // ln(S / S_use) of each stress, such as torque and speed
};

struct StressedLife {
  Lifetime life;
  std::vector<StressStep> steps;  // in order; the last one lasts for ever
};

/// What is known of an exponent from elsewhere: normal about the mean. Deviation zero: fixed; infinite:
/// nothing.
struct ExponentPrior {
  double mean{};
  double deviation{};
};

/// Life by inverse powers of the stresses, and steps by cumulative damage: each time of a step counts as
/// Π (S / S_use)^p of it at the use stresses, τ = Σ Δt Π (S/S_use)^p, and τ has one Weibull law.
struct AcceleratedFit {
  BoundedEstimate shape;
  std::vector<BoundedEstimate> exponents;
  std::vector<BoundedEstimate> quantiles;  // at the use stresses
  double log_likelihood{};                 // with the priors'
  LifetimeCounts counts;
};

/// Maximum likelihood (with priors: of the posterior), likelihood-ratio bounds by profiles, Fisher's beside.
/// `corrected` is the likelihood ratio's.
/// Source: docs/sources.md#nelson-1980 (cumulative exposure); docs/sources.md#meeker-1998, chapter 19.
/// @param priors  one a stress. @param shares_failed  of the quantiles. @param names  of stresses, for words.
/// @throws NoEstimate where nothing failed, or a stress without a prior is the same in all steps.
AcceleratedFit FitAccelerated(std::span<const StressedLife> lives, const std::vector<ExponentPrior>& priors,
                              const std::vector<double>& shares_failed, double level,
                              const std::vector<std::string>& names);

/// Whether all steps that any unit ran in have the same of one stress.
bool IsConstant(std::span<const StressedLife> lives, std::size_t stress);

}  // namespace strainwave::analysis::reliability
