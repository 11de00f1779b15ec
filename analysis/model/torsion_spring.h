// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

namespace strainwave::analysis::model {

/// Torsional spring of the gear seen from the output, input locked (E5): odd, continuous, piecewise linear,
/// with knees at the spring torques ±T₁ and ±T₂.
///
/// Defaults: size 20, ratio 80 and above. T₁, T₂ from the maker's table (docs/effects.md E5 [S]); the
/// slopes are general knowledge [K] that agrees with scaling the size-32 table. To the makers they are means.
struct TorsionSpring {
  double k1_Nm_per_rad{1.6e4};
  double k2_Nm_per_rad{2.5e4};
  double k3_Nm_per_rad{2.9e4};
  double t1_Nm{7.0};
  double t2_Nm{25.0};
};

/// Stands for "no twist at all" where a spring is switched off; finite, so that solvers stay regular.
inline constexpr double kRigid_Nm_per_rad = 1e9;

/// Twist at a spring torque: φ(T) = T/K₁ up to T₁, + (T−T₁)/K₂ up to T₂, + (T−T₂)/K₃ beyond; odd.
inline double SpringTwist(const TorsionSpring& spring, double torque_Nm) noexcept {
  const double load = std::abs(torque_Nm);
  double twist = 0.0;
  if (load <= spring.t1_Nm) {
    twist = load / spring.k1_Nm_per_rad;
  } else if (load <= spring.t2_Nm) {
    twist = spring.t1_Nm / spring.k1_Nm_per_rad + (load - spring.t1_Nm) / spring.k2_Nm_per_rad;
  } else {
    twist = spring.t1_Nm / spring.k1_Nm_per_rad + (spring.t2_Nm - spring.t1_Nm) / spring.k2_Nm_per_rad +
            (load - spring.t2_Nm) / spring.k3_Nm_per_rad;
  }
  return std::copysign(twist, torque_Nm);
}

/// The same law with its knees as twists, for evaluating it often.
struct SpringCurve {
  TorsionSpring spring;
  double knee1_rad{};
  double knee2_rad{};
};
inline SpringCurve CurveOf(const TorsionSpring& spring) noexcept {
  return {spring, SpringTwist(spring, spring.t1_Nm), SpringTwist(spring, spring.t2_Nm)};
}

/// Torque of a spring at a twist, and the slope there (at a knee, the slope towards zero).
struct SpringState {
  double torque_Nm;
  double stiffness_Nm_per_rad;
};
inline SpringState EvaluateSpring(const SpringCurve& curve, double twist_rad) noexcept {
  const TorsionSpring& spring = curve.spring;
  const double magnitude = std::abs(twist_rad);
  if (magnitude <= curve.knee1_rad) return {spring.k1_Nm_per_rad * twist_rad, spring.k1_Nm_per_rad};
  if (magnitude <= curve.knee2_rad) {
    const double torque = spring.t1_Nm + spring.k2_Nm_per_rad * (magnitude - curve.knee1_rad);
    return {std::copysign(torque, twist_rad), spring.k2_Nm_per_rad};
  }
  const double torque = spring.t2_Nm + spring.k3_Nm_per_rad * (magnitude - curve.knee2_rad);
  return {std::copysign(torque, twist_rad), spring.k3_Nm_per_rad};
}

}  // namespace strainwave::analysis::model
