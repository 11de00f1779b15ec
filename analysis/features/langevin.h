// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "analysis/features/sorted_series.h"

namespace strainwave::analysis::features {

/// Largest fixed point of the deterministic part of a Langevin process fitted to the series: the real part of
/// the root, largest in it, of a cubic h. The n − 1 values before a step are put into 30 bins of equal count;
/// h is fitted by least squares to the mean step over the mean value of each bin that is not empty.
///
/// @param x  the series, at least one value, finite.
/// @param sorted  the same values.
/// @return NaN where two bin edges coincide, h vanishes, or nothing can be fitted.
///
/// Source: Friedrich et al., Phys. Lett. A 271 (2000) 217; bins, fit and roots as in tsfresh's
/// `max_langevin_fixed_point(r = 30, m = 3)`.
double LargestLangevinFixedPoint(std::span<const double> x, SortedSeries& sorted);

}  // namespace strainwave::analysis::features
