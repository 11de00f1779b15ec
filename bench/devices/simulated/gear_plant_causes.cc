// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "bench/devices/simulated/gear_plant.h"

/// Effects that a nominal gear does not have.
namespace strainwave::bench {

namespace model = analysis::model;

model::TwistSolution GearPlant::Balance(const model::TwistCurve& curve, double scale,
                                        const model::OutputGrip& grip, double no_load_rad, double load_Nm,
                                        double step_s) noexcept {
  const PlantState& s = state_;
  return model::SolveDeviatingTwist(curve, scale,
                                    {s.hysteresis_anchor_rad, s.further_anchor_rad, s.twist_rad, step_s},
                                    grip, no_load_rad, load_Nm, s.twist_rad);
}

// The rate of the twist counts as damping in the short steps.
model::TwistSolution GearPlant::AtDeflection(const model::TwistCurve& curve, double scale,
                                             double deflection_rad) noexcept {
  const PlantState& s = state_;
  return model::SolveDeviatingTwistAtDeflection(
      curve, scale, {s.hysteresis_anchor_rad, s.further_anchor_rad, s.twist_rad, 0.0}, deflection_rad,
      s.twist_rad);
}

void GearPlant::MoveFurtherAnchors() noexcept {
  for (std::size_t i = 0; i < state_.further_anchor_rad.size(); ++i) {
    state_.further_anchor_rad[i] = model::MovedAnchor(law_.deviations.further_friction[i], state_.twist_rad,
                                                      state_.further_anchor_rad[i]);
  }
}

double GearPlant::YieldOfBrake(double excess_Nm, double step_s) noexcept {
  const double slip_rad = model::BrakeYield_rad(specimen_.brake.yield, excess_Nm, state_.brake_excess_Nm,
                                                state_.brake_furthest_excess_Nm, step_s);
  state_.brake_excess_Nm = excess_Nm;
  state_.brake_furthest_excess_Nm = std::max(state_.brake_furthest_excess_Nm, excess_Nm);
  return slip_rad;
}

void GearPlant::AdvanceExponentialCreep(double step_s) noexcept {
  if (state_.blank_mounted) return;
  state_.exponential_creep_rad = model::AdvancedCreep_rad(specimen_.exponential_creep, state_.gear_torque_Nm,
                                                          step_s, state_.exponential_creep_rad);
}

// An explicit step is stable up to damping · step = twice the inertia that swings; a third of that is smooth.
double GearPlant::ShortStepDamping() const noexcept {
  constexpr double kLongestSubstep_s = 0.25e-3;
  const model::Inertia& inertia = specimen_.inertia;
  const double most = 0.3 / (kLongestSubstep_s * (1.0 / inertia.output_kgm2 +
                                                  inverse_ratio_ * inverse_ratio_ / inertia.input_kgm2));
  return inertia.damping_Nms_per_rad + std::min(law_.deviations.viscous_Nms_per_rad, most);
}

double GearPlant::ExtraDrag_Nm(double speed_rad_per_s) const noexcept {
  if (state_.blank_mounted) return 0.0;
  const model::DriveCauses& causes = specimen_.drive_causes;
  return model::AsymmetricViscous_Nm(causes.viscous_difference_Nms_per_rad, speed_rad_per_s) +
         model::QuadraticDrag_Nm(causes.quadratic_Nms2_per_rad2, speed_rad_per_s);
}

double GearPlant::ExtraLoad_Nm(double input_rad) const noexcept {
  const model::DriveCauses& causes = specimen_.drive_causes;
  double torque_Nm = causes.constant_Nm + model::PeriodicTorque_Nm(causes.periodic, input_rad) +
                     model::PeriodicTorque_Nm(causes.unbalance, input_rad);
  for (const model::TorqueWindow& window : causes.disturbance) {
    torque_Nm += model::WindowTorque_Nm(window, measurement_time_s());
  }
  return torque_Nm;
}

}  // namespace strainwave::bench
