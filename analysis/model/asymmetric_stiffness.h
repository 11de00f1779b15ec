// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace strainwave::analysis::model {

/// Factor on every stiffness of a spring that is stiffer under torque of one sign: 1 + s under positive
/// torque, 1 − s under negative, so that s = (K₊ − K₋) / (K₊ + K₋). The knees stay at their torques.
inline double StiffnessOnSide(double asymmetry_share, double torque_Nm) noexcept {
  return torque_Nm < 0.0 ? 1.0 - asymmetry_share : 1.0 + asymmetry_share;
}

}  // namespace strainwave::analysis::model
