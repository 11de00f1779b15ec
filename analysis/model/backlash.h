// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>

namespace strainwave::analysis::model {

/// Play: a dead zone about zero torque, in series with what bends (docs/effects.md E4). Inside it there is
/// next to no stiffness; the flanks have met at ±`torque_Nm`. It shows as a step of a loop at zero torque, as
/// a difference between the directions of a transmission error, and as lost contact at reversals.
struct Backlash {
  double width_rad{};      // of the whole zone
  double torque_Nm{0.05};  // at its ends, > 0
  /// Flanks that come to bear little by little: tanh(1), 76 % of the play, is through at ±`torque_Nm`.
  bool rounded{};

  double softness_rad_per_Nm() const noexcept { return 0.5 * width_rad / torque_Nm; }
};

/// Angle by which the play gives way to a torque: half the width at its ends and beyond.
inline double BacklashTwist_rad(const Backlash& backlash, double torque_Nm) noexcept {
  if (backlash.rounded) return 0.5 * backlash.width_rad * std::tanh(torque_Nm / backlash.torque_Nm);
  return std::clamp(torque_Nm, -backlash.torque_Nm, backlash.torque_Nm) * backlash.softness_rad_per_Nm();
}

}  // namespace strainwave::analysis::model
