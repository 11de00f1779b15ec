// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "analysis/reliability/weibull_fit.h"

namespace strainwave::analysis::reliability {

/// How far one unit has come to its limit: 0 at its start, 1 at the limit; over cycles above zero, in order.
struct DegradationPath {
  std::vector<double> cycle;
  std::vector<double> way;
};

/// By straight averages of neighbours to at most that many points.
DegradationPath Binned(const DegradationPath& path, std::size_t most);

/// When one unit comes to its limit, from way = a + b cycle^κ + noise, with κ from 0.3 to 4.
struct LimitForecast {
  bool
      is_approached{};  // false: no trend towards the limit that noise would not explain; nothing else is set
  double cycle{};
  Interval interval;  // high ∞: the limit may never be met
  double power{};     // κ
};

/// Interval by the profile of the residual sum over the cycle of meeting, where
/// way − 1 = b (cycle^κ − cycle_met^κ), against F(1, n_eff − 3); n_eff counts fewer where residuals repeat
/// each other (by their lag-1 autocorrelation).
/// @param level  of the two-sided interval. Never before the last cycle: the limit is not met yet.
/// @throws std::invalid_argument for fewer than 8 points, or columns of different lengths.
LimitForecast ForecastLimit(const DegradationPath& path, double level);

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
