// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "analysis/model/backlash.h"
#include "analysis/model/elasto_plastic.h"
#include "analysis/model/torsion_spring.h"

namespace strainwave::analysis::model {

/// What a gear's twist may have beyond the nominal law. All zero in a nominal gear.
struct TwistDeviations {
  double asymmetry_share{};        // (K₊ − K₋) / (K₊ + K₋)
  double hardening_Nm_per_rad3{};  // ≥ 0
  /// Beside the hysteresis element: a loop with a spectrum of them.
  std::array<ElastoPlasticElement, 2> further_friction{{{0.0, 4e-4}, {0.0, 8e-4}}};
  double viscous_Nms_per_rad{};  // on the rate of the twist
  Backlash backlash;
  double backlash_beside_friction{};  // above ½: in series with the spring alone, else with the whole gear

  bool any() const noexcept {
    return asymmetry_share != 0.0 || hardening_Nm_per_rad3 != 0.0 || further_friction[0].limit_Nm != 0.0 ||
           further_friction[1].limit_Nm != 0.0 || viscous_Nms_per_rad != 0.0 || backlash.width_rad != 0.0;
  }
  /// The play that is in series with the whole gear.
  Backlash OuterBacklash() const noexcept {
    return backlash_beside_friction > 0.5 ? Backlash{0.0, backlash.torque_Nm} : backlash;
  }
};

/// The twisting part of the bench between wave generator and output encoder: torsion spring with the
/// hysteresis element beside it, both scaled with the angle of the wave generator (E7), and a compliance in
/// series (docs/effects.md E17).
struct TwistLaw {
  TorsionSpring spring;
  ElastoPlasticElement hysteresis{2.33, 8e-5};
  double series_compliance_rad_per_Nm{};
  TwistDeviations deviations{};
};

/// The law made ready for evaluating it often.
struct TwistCurve {
  SpringCurve spring;
  ElastoPlasticElement hysteresis;
  double hysteresis_stiffness_Nm_per_rad{};
  double series_compliance_rad_per_Nm{};
  bool deviates{};  // from the nominal law: the functions for a deviating gear have to be called
  TwistDeviations deviations{};
};
inline TwistCurve CurveOf(const TwistLaw& law) noexcept {
  return {CurveOf(law.spring),
          law.hysteresis,
          law.hysteresis.stiffness_Nm_per_rad(),
          law.series_compliance_rad_per_Nm,
          law.deviations.any(),
          law.deviations};
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

/// State of a deviating gear between steps.
struct TwistMemory {
  double anchor_rad{};  // of the hysteresis element
  std::array<double, 2> further_anchor_rad{};
  double twist_before_rad{};  // and
  double step_s{};            // since then, for the viscous part; 0 leaves that out
};

/// Torque in a deviating gear at a twist, and its slope. The spring has its stiffness of this side; friction
/// and hardening are the same on both.
SpringState DeviatingTorque(const TwistCurve& curve, double scale, const TwistMemory& memory,
                            double twist_rad) noexcept;

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

/// Both for a deviating gear: with its play, and the torque of `DeviatingTorque`. The viscous part
/// is implicit in the step.
TwistSolution SolveDeviatingTwist(const TwistCurve& curve, double scale, const TwistMemory& memory,
                                  const OutputGrip& grip, double no_load_output_rad, double load_torque_Nm,
                                  double start_twist_rad) noexcept;
TwistSolution SolveDeviatingTwistAtDeflection(const TwistCurve& curve, double scale,
                                              const TwistMemory& memory, double deflection_rad,
                                              double start_twist_rad) noexcept;

}  // namespace strainwave::analysis::model
