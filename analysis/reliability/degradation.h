// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "analysis/reliability/degradation_path.h"
#include "analysis/reliability/weibull_fit.h"

namespace strainwave::analysis::reliability {

/// Life of a population from paths to the limit, met or not.
struct DegradationLife {
  double power{};                          // κ, common
  double noise{};                          // standard deviation about the paths
  double log_slope_deviation{};            // ω: how much ln b differs between units
  std::vector<BoundedEstimate> quantiles;  // cycles; intervals are never below zero
  std::vector<double> pseudo_failures;  // of each unit by its own slope; infinite where it does not approach
};

/// Mixed effects: way_ij = a_i + b_i cycle^κ + e_ij with ln b_i normal over units, a_i free, κ common; lives
/// T_i = b_i^(−1/κ) are lognormal. The integral over each b_i is done by quadrature, so that units that have
/// hardly begun to degrade weigh as little as they tell; bounds are likelihood-ratio profiles.
/// Source: docs/sources.md#lu-1993; docs/sources.md#meeker-1998, chapter 13.
/// @throws NoEstimate for fewer than two units, or where no path approaches the limit.
DegradationLife LifeFromDegradation(std::span<const DegradationPath> paths,
                                    const std::vector<double>& shares_failed, double level);

}  // namespace strainwave::analysis::reliability
