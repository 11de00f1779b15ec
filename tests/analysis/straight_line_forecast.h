// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>

#include "analysis/reliability/degradation_path.h"
#include "analysis/reliability/straight_fit.h"

namespace strainwave::analysis::reliability {

/// Cycle at which a straight line through the whole path meets the limit, what others extrapolate by. Not
/// before the last cycle; ten thousand times that where the line does not rise.
inline double StraightLineForecast(const DegradationPath& seen) {
  constexpr double kMostTimesLonger = 1e4;
  const double last = seen.cycle.back();
  const StraightFit line = FitPower(seen.cycle, seen.way, 1.0);
  if (!(line.slope > 0.0)) return kMostTimesLonger * last;
  return std::clamp((1.0 - line.intercept) / line.slope, last, kMostTimesLonger * last);
}

}  // namespace strainwave::analysis::reliability
