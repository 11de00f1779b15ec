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

/// The residual sum of the best such curve that passes through (x_met, y_met).
double ResidualThrough(std::span<const double> x, std::span<const double> y, double power, double x_met,
                       double y_met);

/// As many independent points as those whose residuals follow each other with lag-1 correlation r:
/// n (1 − r)/(1 + r), with r at least 0.
double EffectiveCount(std::span<const double> x, std::span<const double> y, double power);

}  // namespace strainwave::analysis::reliability
