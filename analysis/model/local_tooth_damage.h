// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

#include "analysis/units.h"

namespace strainwave::analysis::model {

/// Full width at half height of a Gaussian over its standard deviation: √(8 ln 2).
inline constexpr double kWidthPerDeviation = 2.3548200450309493;

/// A damaged tooth: a bump of height one in the transmission error, highest at one place of the output's
/// turn, each flank half a Gaussian. `width_rad` is the full width at half height; the flank towards larger
/// angles has (1 + `skew_share`)/2 of it, −1 < skew_share < 1: a broken edge is met at once and left
/// gradually.
inline double LocalToothDamageShape(double output_rad, double centre_rad, double width_rad,
                                    double skew_share = 0.0) noexcept {
  const double from_centre_rad = std::remainder(output_rad - centre_rad, kTwoPi);
  const double flank = from_centre_rad < 0.0 ? 1.0 - skew_share : 1.0 + skew_share;
  const double away = from_centre_rad * kWidthPerDeviation / (width_rad * flank);
  return std::abs(away) < 8.0 ? std::exp(-0.5 * away * away) : 0.0;
}

}  // namespace strainwave::analysis::model
