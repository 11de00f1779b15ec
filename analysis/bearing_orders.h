// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

#include "analysis/arguments.h"

namespace strainwave::analysis {

/// What a rolling bearing is, by count and diameters.
struct RollingBearing {
  int elements{};  // balls or rollers
  double element_diameter_m{};
  double pitch_diameter_m{};  // of the circle on which their middles run
  double contact_angle_rad{};
};

/// How often a turn of the inner ring something passes, the outer ring at rest.
struct BearingOrders {
  double outer_race{};  // a place on the outer race is rolled over
  double inner_race{};  // a place on the inner race is rolled over
  double element{};     // a place on an element meets a race, either of the two
  double cage{};        // turns of the cage
};

/// With γ = d cos α / D and n elements: (n/2)(1 − γ), (n/2)(1 + γ), (D/d)(1 − γ²), (1 − γ)/2. Slip, which
/// keeps real ones a percent or two off, is not in them.
/// @throws std::invalid_argument if there is no element, or the diameters are not 0 < d < D, or the angle is
///   not in 0 … 90°.
///
/// Source: docs/sources.md#randall-2011, eq. 1 to 4; the third there is half of this.
inline BearingOrders BearingOrdersOf(const RollingBearing& bearing) {
  RequirePositive("elements", static_cast<double>(bearing.elements));
  RequirePositive("element_diameter_m", bearing.element_diameter_m);
  RequirePositive("pitch_diameter_m", bearing.pitch_diameter_m);
  if (!(bearing.element_diameter_m < bearing.pitch_diameter_m))
    throw std::invalid_argument(fmt::format("element_diameter_m = {} is not below pitch_diameter_m = {}",
                                            bearing.element_diameter_m, bearing.pitch_diameter_m));
  constexpr double kRightAngle_rad = 1.5707963267948966;
  if (!(bearing.contact_angle_rad >= 0.0 && bearing.contact_angle_rad < kRightAngle_rad))
    throw std::invalid_argument(
        fmt::format("contact_angle_rad = {} is not in 0 to below π/2", bearing.contact_angle_rad));
  const double ratio = bearing.element_diameter_m / bearing.pitch_diameter_m;
  const double gamma = ratio * std::cos(bearing.contact_angle_rad);
  const double half = 0.5 * bearing.elements;
  return {.outer_race = half * (1.0 - gamma),
          .inner_race = half * (1.0 + gamma),
          .element = (1.0 - gamma * gamma) / ratio,
          .cage = 0.5 * (1.0 - gamma)};
}

}  // namespace strainwave::analysis
