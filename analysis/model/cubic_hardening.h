// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace strainwave::analysis::model {

/// Torque that a spring takes beyond its piecewise-linear law, T = a φ³, and its slope (docs/effects.md E5).
inline double CubicTorque_Nm(double hardening_Nm_per_rad3, double twist_rad) noexcept {
  return hardening_Nm_per_rad3 * twist_rad * twist_rad * twist_rad;
}
inline double CubicStiffness_Nm_per_rad(double hardening_Nm_per_rad3, double twist_rad) noexcept {
  return 3.0 * hardening_Nm_per_rad3 * twist_rad * twist_rad;
}

}  // namespace strainwave::analysis::model
