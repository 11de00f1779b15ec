// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>

namespace strainwave::analysis::model {

/// Torque by which a locked shaft is loaded beyond what its brake holds; signed, 0 below. Both seen from the
/// output.
inline double TorqueBeyond_Nm(double torque_Nm, double holding_torque_Nm) noexcept {
  return std::copysign(std::max(std::abs(torque_Nm) - holding_torque_Nm, 0.0), torque_Nm);
}

/// What a step in which the torque goes in a straight line adds to the time beyond the holding torque
/// (counted with the torque's sign, s) and to the impulse beyond it (Nm·s): a brake that slips at one speed
/// follows the first, one whose speed grows with the excess the second. Exact.
struct BeyondHolding {
  double time_s{};
  double impulse_Nms{};
};
inline BeyondHolding StepBeyond(double from_Nm, double to_Nm, double holding_torque_Nm,
                                double step_s) noexcept {
  const double begin_Nm = TorqueBeyond_Nm(from_Nm, holding_torque_Nm);
  const double end_Nm = TorqueBeyond_Nm(to_Nm, holding_torque_Nm);
  const double change_Nm = to_Nm - from_Nm;
  if (std::abs(change_Nm) < 1e-9) {
    const double sign = end_Nm > 0.0 ? 1.0 : end_Nm < 0.0 ? -1.0 : 0.0;
    return {sign * step_s, end_Nm * step_s};
  }
  // Antiderivatives over the torque of sign(T) beyond and of the excess: |excess| and excess² / 2.
  const double per_torque = step_s / change_Nm;
  return {(std::abs(end_Nm) - std::abs(begin_Nm)) * per_torque,
          0.5 * (end_Nm * end_Nm - begin_Nm * begin_Nm) * per_torque};
}

}  // namespace strainwave::analysis::model
