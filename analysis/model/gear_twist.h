// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "analysis/model/elasto_plastic.h"
#include "analysis/model/torsion_spring.h"

namespace strainwave::analysis::model {

/// The twisting part of the bench between wave generator and output encoder: torsion spring with the
/// hysteresis element beside it, both scaled with the angle of the wave generator (E7), and a compliance in
/// series (E17).
struct TwistLaw {
  TorsionSpring spring;
  ElastoPlasticElement hysteresis{2.33, 8e-5};
  double series_compliance_rad_per_Nm{};
};

/// The law made ready for evaluating it often.
struct TwistCurve {
  SpringCurve spring;
  ElastoPlasticElement hysteresis;
  double hysteresis_stiffness_Nm_per_rad{};
  double series_compliance_rad_per_Nm{};
};
inline TwistCurve CurveOf(const TwistLaw& law) noexcept {
  return {CurveOf(law.spring), law.hysteresis, law.hysteresis.stiffness_Nm_per_rad(),
          law.series_compliance_rad_per_Nm};
}

/// Torque in the gear at a twist, and its slope, with the anchor as it was.
/// `scale` > 0 multiplies every slope of the spring and leaves the knees at their torques.
inline SpringState GearTorque(const TwistCurve& curve, double scale, double anchor_rad,
                              double twist_rad) noexcept {
  SpringState state = EvaluateSpring(curve.spring, scale * twist_rad);
  state.stiffness_Nm_per_rad *= scale;
  const double stuck_Nm = (twist_rad - anchor_rad) * curve.hysteresis_stiffness_Nm_per_rad;
  if (stuck_Nm > curve.hysteresis.limit_Nm) {
    state.torque_Nm += curve.hysteresis.limit_Nm;
  } else if (stuck_Nm < -curve.hysteresis.limit_Nm) {
    state.torque_Nm -= curve.hysteresis.limit_Nm;
  } else {
    state.torque_Nm += stuck_Nm;
    state.stiffness_Nm_per_rad += curve.hysteresis_stiffness_Nm_per_rad;
  }
  return state;
}

/// What grips the output besides the load torque: the drag of the load train, or its brake. An
/// elasto-plastic element on the output angle.
struct OutputGrip {
  ElastoPlasticElement element;
  double stiffness_Nm_per_rad{};
  double anchor_rad{};
};

/// A static state of the gear.
struct TwistSolution {
  double twist_rad;   // of the gear alone
  double torque_Nm;   // through gear and transducer
  double output_rad;  // output angle = no-load angle + twist + series deflection
};

/// Solves torque balance on the output: gear torque = load torque − grip(output angle). One rising,
/// piecewise-linear equation in the twist; Newton's method from `start_twist_rad`, kept inside a bracket, so
/// it always ends and usually after one or two steps.
/// @param no_load_output_rad  output angle at zero twist and zero torque.
/// @param load_torque_Nm      external torque on the output, positive drives it forward.
TwistSolution SolveTwist(const TwistCurve& curve, double scale, double anchor_rad, const OutputGrip& grip,
                         double no_load_output_rad, double load_torque_Nm, double start_twist_rad) noexcept;

/// Torque through gear and series compliance at a given total deflection (both together), same method.
TwistSolution SolveTwistAtDeflection(const TwistCurve& curve, double scale, double anchor_rad,
                                     double deflection_rad, double start_twist_rad) noexcept;

}  // namespace strainwave::analysis::model
