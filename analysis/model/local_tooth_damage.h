// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

#include "analysis/units.h"

namespace strainwave::analysis::model {

/// Full width at half height of a Gaussian over its standard deviation: √(8 ln 2).
inline constexpr double kWidthPerDeviation = 2.3548200450309493;

/// A damaged tooth: a Gaussian bump of height one in the transmission error, around one place of the output's
/// turn. `width_rad` is the full width at half height.
inline double LocalToothDamageShape(double output_rad, double centre_rad, double width_rad) noexcept {
  const double away = std::remainder(output_rad - centre_rad, kTwoPi) * kWidthPerDeviation / width_rad;
  return std::abs(away) < 8.0 ? std::exp(-0.5 * away * away) : 0.0;
}

}  // namespace strainwave::analysis::model
