// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

namespace strainwave::analysis::reliability {

/// Least squares of y = intercept + slope x^power.
struct StraightFit {
  double intercept{};
  double slope{};
  double slope_spread{};  // variance of the slope over that of the noise
  double residual_sum{};
};
StraightFit FitPower(std::span<const double> x, std::span<const double> y, double power);

}  // namespace strainwave::analysis::reliability
