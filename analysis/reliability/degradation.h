// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "analysis/reliability/degradation_path.h"
#include "analysis/reliability/profile.h"

namespace strainwave::analysis::reliability {

/// Of a posterior.
struct LifeQuantile {
  double value{};  // median
  Interval interval;
};

/// Life of a population from paths to the limit, met or not.
struct DegradationLife {
  LifeQuantile log_deviation;           // of ln(life) between units
  std::vector<LifeQuantile> quantiles;  // cycles
  std::vector<double> pseudo_failures;  // of each unit by its own trend; ∞ where it does not approach
};

/// Mixed effects, in two stages: the trend of each unit gives its life with that trend's own uncertainty
/// (rate_trend.h, no law assumed), lives are lognormal over units, and the uncertainties of both are carried
/// into the intervals. What trends do after their last cycle is one and the same in all units, for they wear
/// by one law: more units do not make that better known. A unit that has met its limit is a failure at that
/// cycle, one that does not approach it is suspended at its last. Equal-tailed posterior intervals.
/// Source: docs/sources.md#lu-1993 (two stages); docs/sources.md#gelman-2006 (the deviation's prior).
/// @param shares_failed  of the quantiles, within (0, 1).
/// @param level  of the intervals, within (0, 1).
/// @throws NoEstimate for fewer than two units, or where no path approaches the limit.
/// @throws std::invalid_argument as RequirePath.
DegradationLife LifeFromDegradation(std::span<const DegradationPath> paths,
                                    const std::vector<double>& shares_failed, double level);

}  // namespace strainwave::analysis::reliability
