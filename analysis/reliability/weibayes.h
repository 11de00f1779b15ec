// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "analysis/reliability/lifetimes.h"
#include "analysis/reliability/profile.h"

namespace strainwave::analysis::reliability {

/// A Weibull law whose shape is known from elsewhere: what none or one failure allows.
struct Weibayes {
  double shape{};
  std::optional<double> scale;  // η of maximum likelihood; none where nothing failed
  Interval scale_bounds;        // two-sided; each end alone holds with (1 + level) / 2
  std::optional<double> quantile;
  Interval quantile_bounds;
};

/// (t/η)^β is exponential where β is known, so that η has χ² bounds: low η^β = 2 Σ t^β / χ²(2 r + 2), high
/// 2 Σ t^β / χ²(2 r), of r failures; the low one is exact for units that are watched until a time, and for
/// none of n that failed it is that R(t) = (1 − C)^(1/n) at equal times. A failure within an interval is
/// taken at the interval's beginning, one before a time at zero: the bounds are then too low rather than too
/// high. Source: docs/sources.md#nelson-1985.
/// @param level  of the two-sided interval. @param share_failed  of the quantile: 0.1 for B10.
/// @throws std::invalid_argument for lives that are none, a shape that is not positive, no unit that ran.
Weibayes FitWeibayes(std::span<const Lifetime> lifetimes, double shape, double share_failed, double level);

/// The same over shapes from a half to twice that one.
std::vector<Weibayes> WeibayesSensitivity(std::span<const Lifetime> lifetimes, double shape,
                                          double share_failed, double level);

/// The shape that two quantiles fix, such as a maker's L10 and L50.
/// @throws std::invalid_argument unless 0 < early share < late share < 1 and 0 < early < late.
double ShapeOfQuantiles(double early_share, double early, double late_share, double late);

}  // namespace strainwave::analysis::reliability
