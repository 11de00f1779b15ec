// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

#include "analysis/transmission_error.h"

namespace strainwave::analysis {

/// So many standard errors to either side of a normal estimate hold 95 %.
inline constexpr double kStandardErrorsOf95 = 1.959963984540054;

/// Half width of the two-sided 95 % interval; zero where the estimate has no standard error.
inline double HalfWidthOf95(const Estimate& estimate) {
  return estimate.standard_error > 0.0 ? kStandardErrorsOf95 * estimate.standard_error : 0.0;
}

/// `after` less `before`, both errors taken to be independent: too wide where both share one, as of a
/// calibration.
inline Estimate ChangeBetween(const Estimate& before, const Estimate& after) {
  return {after.value - before.value, std::hypot(before.standard_error, after.standard_error)};
}

}  // namespace strainwave::analysis
