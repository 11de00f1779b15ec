// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

namespace strainwave::analysis::model {

/// Friction of one joint, Coulomb, viscous and Stribeck, all by the sign of the velocity:
///
///   τ = F_c sgn q̇ + F_v q̇ + (F_s − F_c) exp(−(q̇ / v_s)²) sgn q̇
///
/// Source: docs/sources.md#actuators-2025, eq. 4.
struct JointFriction {
  double coulomb_Nm{};
  double breakaway_Nm{};  // F_s
  double stribeck_rad_per_s{0.05};
  double viscous_Nms_per_rad{};
};

/// The sign of a velocity, with a slope about zero in place of a step: a joint that creeps is held by less.
inline double SmoothSign(double velocity_rad_per_s) noexcept {
  constexpr double kCreep_rad_per_s = 2e-3;
  return std::tanh(velocity_rad_per_s / kCreep_rad_per_s);
}

inline double FrictionTorque_Nm(const JointFriction& friction, double velocity_rad_per_s) noexcept {
  const double share = velocity_rad_per_s / friction.stribeck_rad_per_s;
  return (friction.coulomb_Nm + (friction.breakaway_Nm - friction.coulomb_Nm) * std::exp(-share * share)) *
             SmoothSign(velocity_rad_per_s) +
         friction.viscous_Nms_per_rad * velocity_rad_per_s;
}

/// A brake that drags: its disk does not come free, and holds against any motion by the same torque.
inline double BrakeDrag_Nm(double drag_Nm, double velocity_rad_per_s) noexcept {
  return drag_Nm * SmoothSign(velocity_rad_per_s);
}

/// A worn reducer: more friction of every part, and teeth that pass unevenly.
struct ReducerWear {
  double friction_share{};  // 0.3: 30 % more friction
  double ripple_share{};    // of the friction, once a tooth
  double teeth_per_turn{};  // of the joint
  double phase_rad{};
};

inline double WearTorque_Nm(const ReducerWear& wear, double friction_Nm, double position_rad) noexcept {
  return friction_Nm * (wear.friction_share +
                        wear.ripple_share * std::sin(wear.teeth_per_turn * position_rad + wear.phase_rad));
}

}  // namespace strainwave::analysis::model
