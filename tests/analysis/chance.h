// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

#include <gtest/gtest.h>

namespace strainwave::analysis {

/// Standard deviations within which a normally distributed value stays but for one in a thousand. Tests draw
/// from fixed seeds, so that they pass or fail for good; a bound of so many says that of a thousand other
/// seeds 999 would have passed as well.
inline constexpr double kByChance = 3.29;

/// Standard deviation, as a share of itself, of a standard deviation that is estimated from so many degrees
/// of freedom of a normal distribution.
inline double SpreadOfDeviation(double degrees_of_freedom) {
  return 1.0 / std::sqrt(2.0 * degrees_of_freedom);
}

/// Of how many of `trials` come true, each with `probability`.
inline double SpreadOfCount(double trials, double probability) {
  return std::sqrt(trials * probability * (1.0 - probability));
}

/// As many as `probability` says came true, but for chance.
inline void ExpectShare(double came_true, double trials, double probability) {
  EXPECT_NEAR(came_true, trials * probability, kByChance * SpreadOfCount(trials, probability));
}

/// Intervals of 1.96 standard errors held the truth `held` times.
inline void ExpectCoverageOf95(double held, double trials) { ExpectShare(held, trials, 0.95); }

}  // namespace strainwave::analysis
