// SPDX-License-Identifier: Apache-2.0
#include "analysis/model/gear_twist.h"

#include <cmath>
#include <limits>

#include "analysis/model/asymmetric_stiffness.h"
#include "analysis/model/cubic_hardening.h"

namespace strainwave::analysis::model {
namespace {

// Far below anything the sensors resolve, far above rounding.
constexpr double kTorqueTolerance_Nm = 1e-10;
constexpr double kTwistTolerance_rad = 1e-14;
constexpr int kMostSteps = 60;  // a bisection of the whole range ends long before

struct Residual {
  double value;
  double slope;
};

// Finds the zero of a strictly rising function, linear in pieces or nearly. A Newton step that would leave
// the bracket (it may cycle between two pieces) is replaced by halving the bracket. What is returned is the
// last place at which the function was evaluated.
template <typename Function>
double RisingZero(const Function& function, double start, double tolerance) noexcept {
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();
  double x = start;
  for (int step = 0; step < kMostSteps; ++step) {
    const Residual residual = function(x);
    if (std::abs(residual.value) < tolerance) return x;
    (residual.value > 0.0 ? high : low) = x;
    double next = x - residual.value / residual.slope;
    if (!(next > low && next < high)) next = 0.5 * (low + high);
    if (std::abs(next - x) < kTwistTolerance_rad) return x;
    x = next;
  }
  return x;
}

// Deflection of what is in series with the gear at a torque, and its slope.
struct Series {
  double deflection_rad;
  double compliance_rad_per_Nm;
};

// The balance on the output, over any law of the gear (twist → torque, slope) and of what is in series with
// it.
template <typename GearLaw, typename SeriesLaw>
TwistSolution Balance(const GearLaw& gear_law, const SeriesLaw& series_law, const OutputGrip& grip,
                      double no_load_output_rad, double load_torque_Nm, double start_twist_rad) noexcept {
  const double grip_stiffness = grip.stiffness_Nm_per_rad;
  SpringState gear{};
  const auto residual = [&](double twist_rad) noexcept -> Residual {
    gear = gear_law(twist_rad);
    const Series series = series_law(gear.torque_Nm);
    const double output_rad = no_load_output_rad + twist_rad + series.deflection_rad;
    const double stuck_Nm = (output_rad - grip.anchor_rad) * grip_stiffness;
    const double limit = grip.element.limit_Nm;
    if (stuck_Nm > limit) return {gear.torque_Nm - load_torque_Nm + limit, gear.stiffness_Nm_per_rad};
    if (stuck_Nm < -limit) return {gear.torque_Nm - load_torque_Nm - limit, gear.stiffness_Nm_per_rad};
    return {gear.torque_Nm - load_torque_Nm + stuck_Nm,
            gear.stiffness_Nm_per_rad +
                grip_stiffness * (1.0 + series.compliance_rad_per_Nm * gear.stiffness_Nm_per_rad)};
  };
  const double twist_rad = RisingZero(residual, start_twist_rad, kTorqueTolerance_Nm);
  return {twist_rad, gear.torque_Nm,
          no_load_output_rad + twist_rad + series_law(gear.torque_Nm).deflection_rad};
}

// The twist at which gear and series together come to a deflection.
template <typename GearLaw, typename SeriesLaw>
TwistSolution Share(const GearLaw& gear_law, const SeriesLaw& series_law, double deflection_rad,
                    double start_twist_rad) noexcept {
  SpringState gear{};
  const auto residual = [&](double twist_rad) noexcept -> Residual {
    gear = gear_law(twist_rad);
    const Series series = series_law(gear.torque_Nm);
    return {twist_rad + series.deflection_rad - deflection_rad,
            1.0 + series.compliance_rad_per_Nm * gear.stiffness_Nm_per_rad};
  };
  const double twist_rad = RisingZero(residual, start_twist_rad, kTwistTolerance_rad);
  return {twist_rad, gear.torque_Nm, deflection_rad};
}

Series SeriesWithPlay(const TwistCurve& curve, double torque_Nm) noexcept {
  const Backlash play = curve.deviations.OuterBacklash();
  const double softness = std::abs(torque_Nm) < play.torque_Nm ? play.softness_rad_per_Nm() : 0.0;
  return {curve.series_compliance_rad_per_Nm * torque_Nm + BacklashTwist_rad(play, torque_Nm),
          curve.series_compliance_rad_per_Nm + softness};
}

// The spring with its dead zone, where it has one of its own: soft up to the zone's end, then as if the twist
// were less by half the width.
SpringState SpringWithPlay(const TwistCurve& curve, double scale, double twist_rad) noexcept {
  const TwistDeviations& deviations = curve.deviations;
  const double side = scale * StiffnessOnSide(deviations.asymmetry_share, twist_rad);
  double beyond_rad = twist_rad;
  if (deviations.backlash_beside_friction > 0.5 && deviations.backlash.width_rad > 0.0) {
    const double half_rad = 0.5 * deviations.backlash.width_rad;
    const double end_Nm = deviations.backlash.torque_Nm;
    const double end_rad = half_rad + end_Nm / (side * curve.spring.spring.k1_Nm_per_rad);
    if (std::abs(twist_rad) <= end_rad) return {end_Nm / end_rad * twist_rad, end_Nm / end_rad};
    beyond_rad -= std::copysign(half_rad, twist_rad);
  }
  SpringState state = EvaluateSpring(curve.spring, side * beyond_rad);
  state.stiffness_Nm_per_rad *= side;
  return state;
}

void AddElement(const ElastoPlasticElement& element, double anchor_rad, double twist_rad,
                SpringState& state) noexcept {
  const double carried_Nm = ElementTorque(element, twist_rad, anchor_rad);
  state.torque_Nm += carried_Nm;
  if (std::abs(carried_Nm) < element.limit_Nm) state.stiffness_Nm_per_rad += element.stiffness_Nm_per_rad();
}

}  // namespace

SpringState DeviatingTorque(const TwistCurve& curve, double scale, const TwistMemory& memory,
                            double twist_rad) noexcept {
  const TwistDeviations& deviations = curve.deviations;
  SpringState state = SpringWithPlay(curve, scale, twist_rad);
  state.torque_Nm += CubicTorque_Nm(deviations.hardening_Nm_per_rad3, twist_rad);
  state.stiffness_Nm_per_rad += CubicStiffness_Nm_per_rad(deviations.hardening_Nm_per_rad3, twist_rad);
  AddElement(curve.hysteresis, memory.anchor_rad, twist_rad, state);
  for (std::size_t i = 0; i < deviations.further_friction.size(); ++i) {
    AddElement(deviations.further_friction[i], memory.further_anchor_rad[i], twist_rad, state);
  }
  if (memory.step_s > 0.0) {
    const double per_twist = deviations.viscous_Nms_per_rad / memory.step_s;
    state.torque_Nm += per_twist * (twist_rad - memory.twist_before_rad);
    state.stiffness_Nm_per_rad += per_twist;
  }
  return state;
}

TwistSolution SolveTwist(const TwistCurve& curve, double scale, double anchor_rad, const OutputGrip& grip,
                         double no_load_output_rad, double load_torque_Nm, double start_twist_rad) noexcept {
  const double compliance = curve.series_compliance_rad_per_Nm;
  return Balance([&](double twist_rad) noexcept { return GearTorque(curve, scale, anchor_rad, twist_rad); },
                 [=](double torque_Nm) noexcept {
                   return Series{compliance * torque_Nm, compliance};
                 },
                 grip, no_load_output_rad, load_torque_Nm, start_twist_rad);
}

TwistSolution SolveTwistAtDeflection(const TwistCurve& curve, double scale, double anchor_rad,
                                     double deflection_rad, double start_twist_rad) noexcept {
  const double compliance = curve.series_compliance_rad_per_Nm;
  if (compliance == 0.0) {
    return {deflection_rad, GearTorque(curve, scale, anchor_rad, deflection_rad).torque_Nm, deflection_rad};
  }
  return Share([&](double twist_rad) noexcept { return GearTorque(curve, scale, anchor_rad, twist_rad); },
               [=](double torque_Nm) noexcept {
                 return Series{compliance * torque_Nm, compliance};
               },
               deflection_rad, start_twist_rad);
}

TwistSolution SolveDeviatingTwist(const TwistCurve& curve, double scale, const TwistMemory& memory,
                                  const OutputGrip& grip, double no_load_output_rad, double load_torque_Nm,
                                  double start_twist_rad) noexcept {
  return Balance([&](double twist_rad) noexcept { return DeviatingTorque(curve, scale, memory, twist_rad); },
                 [&](double torque_Nm) noexcept { return SeriesWithPlay(curve, torque_Nm); }, grip,
                 no_load_output_rad, load_torque_Nm, start_twist_rad);
}

TwistSolution SolveDeviatingTwistAtDeflection(const TwistCurve& curve, double scale,
                                              const TwistMemory& memory, double deflection_rad,
                                              double start_twist_rad) noexcept {
  return Share([&](double twist_rad) noexcept { return DeviatingTorque(curve, scale, memory, twist_rad); },
               [&](double torque_Nm) noexcept { return SeriesWithPlay(curve, torque_Nm); }, deflection_rad,
               start_twist_rad);
}

}  // namespace strainwave::analysis::model
