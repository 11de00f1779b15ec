// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "bench/devices/simulated/gear_plant.h"

/// The two ways of stepping; what both share is in gear_plant.cc.
namespace strainwave::bench {

namespace model = analysis::model;

namespace {

constexpr double kSubstep_s = 0.25e-3;

// Speed loop of the load servo, at the output: 2.39 Nm behind 1:70, and slow enough for the lag of its
// torque.
constexpr double kLoadRatedTorque_Nm = 167.0;
constexpr double kLoadSpeedBandwidth_rad_per_s = 60.0;

using Input = PlantCommands::Input;

}  // namespace

double GearPlant::ReflectedInertia() const noexcept {
  return specimen_.inertia.input_kgm2 + specimen_.inertia.output_kgm2 * (inverse_ratio_ * inverse_ratio_);
}

double GearPlant::ReachableSpeed(double wanted_rad_per_s, double step_s) const noexcept {
  const model::DrivingServo& servo = specimen_.servo;
  const double per_torque = step_s / ReflectedInertia();
  const double most = (servo.peak_torque_Nm - state_.servo_integral_Nm) * per_torque;
  const double least = (-servo.peak_torque_Nm - state_.servo_integral_Nm) * per_torque;
  const double bounded = std::clamp(wanted_rad_per_s, -servo.top_speed_rad_per_s, servo.top_speed_rad_per_s);
  const double from = state_.input_speed_rad_per_s;
  return from + std::clamp(bounded - from, least, most);
}

double GearPlant::ApproachSpeed(double remaining_rad, double wanted_rad_per_s) const noexcept {
  // Never faster than half of the servo's torque can still brake; it matters with the blank, where the servo
  // turns the whole output at one to one.
  const double braking = 0.5 * specimen_.servo.peak_torque_Nm / ReflectedInertia();
  const double most = std::sqrt(2.0 * braking * std::abs(remaining_rad));
  return std::clamp(wanted_rad_per_s, -most, most);
}

template <bool kExtended>
void GearPlant::StepQuasiStatic(const PlantCommands& commands, double step_s) noexcept {
  PrepareFactors(quasi_static_, step_s);
  PlantState& s = state_;
  const double from_rad = s.input_rad;
  const double from_output_rad = s.output_rad;
  const double from_speed = s.input_speed_rad_per_s;

  double speed = 0.0;
  if (s.input_brake_closed) {
    s.brake_anchor_rad += SlipBrake(step_s);
  } else if (commands.input == Input::kSpeed) {
    // The speed loop is much faster than the step: the set point is reached unless torque runs out.
    speed = ReachableSpeed(commands.input_set_point, step_s);
    s.input_rad += 0.5 * (from_speed + speed) * step_s;
  } else if (commands.input == Input::kPosition) {
    const double remaining_rad = commands.input_set_point - s.input_rad;
    speed =
        ReachableSpeed(ApproachSpeed(remaining_rad, remaining_rad * quasi_static_.position / step_s), step_s);
    s.input_rad += speed * step_s;
  }
  const double acceleration = s.input_brake_closed ? 0.0 : (speed - from_speed) / step_s;
  s.input_speed_rad_per_s = speed;

  s.load_torque_Nm += (AskedOfLoad(commands, step_s) - s.load_torque_Nm) * quasi_static_.load_lag;

  // Locked, the brake gives way with the torque; that part is counted as compliance in series.
  const double held_rad = s.input_brake_closed ? s.brake_anchor_rad : s.input_rad;
  const AtAngle at = Evaluate<kExtended>(held_rad);
  const double load_Nm = DisturbedLoad(commands, at.output_sin) -
                         specimen_.inertia.output_kgm2 * acceleration * inverse_ratio_ -
                         specimen_.load.drag_viscous_Nms_per_rad * speed * inverse_ratio_;
  double no_load_rad =
      held_rad * inverse_ratio_ + s.mount_offset_rad - at.error_rad + model::CreepTwist_rad(s.creep_rad);
  if (kExtended && has_exponential_creep_) no_load_rad += s.exponential_creep_rad;
  const model::TwistCurve& curve = s.input_brake_closed ? locked_curve_ : free_curve_;
  const model::OutputGrip grip = Grip();
  const model::TwistSolution solution =
      kExtended && curve.deviates ? Balance(curve, at.stiffness_scale, grip, no_load_rad, load_Nm, step_s)
                                  : model::SolveTwist(curve, at.stiffness_scale, s.hysteresis_anchor_rad,
                                                      grip, no_load_rad, load_Nm, s.twist_rad);
  s.twist_rad = solution.twist_rad;
  s.gear_torque_Nm = solution.torque_Nm;
  s.output_rad = solution.output_rad;
  s.output_speed_rad_per_s = (s.output_rad - from_output_rad) / step_s;
  s.hysteresis_anchor_rad = model::MovedAnchor(curve.hysteresis, s.twist_rad, s.hysteresis_anchor_rad);
  if (kExtended && curve.deviates) MoveFurtherAnchors();
  s.grip_anchor_rad = model::MovedAnchor(grip.element, s.output_rad, s.grip_anchor_rad);
  model::AdvanceCreep(quasi_static_.creep, s.gear_torque_Nm, s.creep_rad);
  if (kExtended && has_exponential_creep_) AdvanceExponentialCreep(step_s);

  double friction_Nm = 0.0;
  if (s.input_brake_closed) {
    s.input_rad = held_rad;
    if (!s.blank_mounted)
      s.input_rad += specimen_.brake.compliance_rad_per_Nm * s.gear_torque_Nm * inverse_ratio_;
    s.motor_torque_Nm = s.servo_integral_Nm = 0.0;
  } else {
    const double dry_Nm = model::DryFriction_Nm(friction_, speed, s.gear_torque_Nm, at.cos1, at.cos2);
    friction_Nm = InputFriction(dry_Nm, speed);
    if (kExtended && has_drive_causes_) friction_Nm += ExtraDrag_Nm(speed);
    const double back_Nm = s.gear_torque_Nm * inverse_ratio_ * (1.0 - ratio_ * at.error_derivative);
    // The steady part is kept apart: short steps that follow go on from it.
    const bool driven = commands.input != PlantCommands::Input::kFree;
    s.servo_integral_Nm = driven ? friction_Nm - back_Nm + specimen_.servo.cogging_Nm * at.cos8 : 0.0;
    if (kExtended && driven && has_drive_causes_) s.servo_integral_Nm += ExtraLoad_Nm(held_rad);
    s.motor_torque_Nm = s.servo_integral_Nm + specimen_.inertia.input_kgm2 * acceleration;
  }
  Account(s.input_rad - from_rad, friction_Nm, step_s);
}

template <bool kExtended>
void GearPlant::StepDynamic(const PlantCommands& commands, double step_s) noexcept {
  const int substeps = static_cast<int>(std::ceil(step_s / kSubstep_s - 1e-9));
  const double substep_s = step_s / substeps;
  for (int i = 0; i < substeps; ++i) Substep<kExtended>(commands, substep_s);
}

double GearPlant::ServoTorque(const PlantCommands& commands, double step_s) noexcept {
  PlantState& s = state_;
  const model::DrivingServo& servo = specimen_.servo;
  double wanted_speed = 0.0;
  switch (commands.input) {
    case PlantCommands::Input::kFree:
      s.servo_integral_Nm = 0.0;
      return 0.0;
    case PlantCommands::Input::kTorque:
      s.servo_integral_Nm = 0.0;
      return std::clamp(commands.input_set_point, -servo.peak_torque_Nm, servo.peak_torque_Nm);
    case PlantCommands::Input::kSpeed:
      wanted_speed = commands.input_set_point;
      break;
    case PlantCommands::Input::kPosition:
      wanted_speed = servo.position_gain_per_s * (commands.input_set_point - s.input_rad);
      break;
  }
  wanted_speed = std::clamp(wanted_speed, -servo.top_speed_rad_per_s, servo.top_speed_rad_per_s);
  const double gain = ReflectedInertia() * servo.speed_bandwidth_rad_per_s;
  const double error = wanted_speed - s.input_speed_rad_per_s;
  const double asked_Nm = gain * error + s.servo_integral_Nm;
  const double torque_Nm = std::clamp(asked_Nm, -servo.peak_torque_Nm, servo.peak_torque_Nm);
  // The integral stands still while the torque is at its limit.
  if (asked_Nm == torque_Nm) {
    s.servo_integral_Nm += 0.2 * servo.speed_bandwidth_rad_per_s * gain * error * step_s;
  }
  return torque_Nm;
}

double GearPlant::AskedOfLoad(const PlantCommands& commands, double step_s) noexcept {
  if (!commands.load_enabled || !commands.load_speed_rad_per_s) {
    load_integral_Nm_ = 0.0;
    return commands.load_enabled ? commands.load_torque_Nm : 0.0;
  }
  const double gain = ReflectedInertia() * ratio_ * ratio_ * kLoadSpeedBandwidth_rad_per_s;
  const double error = *commands.load_speed_rad_per_s - state_.output_speed_rad_per_s;
  load_integral_Nm_ =
      std::clamp(load_integral_Nm_ + 0.2 * kLoadSpeedBandwidth_rad_per_s * gain * error * step_s,
                 -kLoadRatedTorque_Nm, kLoadRatedTorque_Nm);
  return std::clamp(gain * error + load_integral_Nm_, -kLoadRatedTorque_Nm, kLoadRatedTorque_Nm);
}

template <bool kExtended>
void GearPlant::Substep(const PlantCommands& commands, double step_s) noexcept {
  PrepareFactors(substep_, step_s);
  PlantState& s = state_;
  const double from_rad = s.input_rad;
  s.load_torque_Nm += (AskedOfLoad(commands, step_s) - s.load_torque_Nm) * substep_.load_lag;

  const bool locked = s.input_brake_closed;
  if (locked) s.brake_anchor_rad += SlipBrake(step_s);
  const double held_rad = locked ? s.brake_anchor_rad : s.input_rad;
  const AtAngle at = Evaluate<kExtended>(held_rad);
  double creep_rad = model::CreepTwist_rad(s.creep_rad);
  if (kExtended && has_exponential_creep_) creep_rad += s.exponential_creep_rad;
  const double deflection_rad =
      s.output_rad - (held_rad * inverse_ratio_ + s.mount_offset_rad - at.error_rad + creep_rad);
  const model::TwistCurve& curve = locked ? locked_curve_ : free_curve_;
  const model::TwistSolution solution =
      kExtended && curve.deviates
          ? AtDeflection(curve, at.stiffness_scale, deflection_rad)
          : model::SolveTwistAtDeflection(curve, at.stiffness_scale, s.hysteresis_anchor_rad, deflection_rad,
                                          s.twist_rad);
  const double input_speed = locked ? 0.0 : s.input_speed_rad_per_s;
  const double slip_speed =
      s.output_speed_rad_per_s - input_speed * inverse_ratio_ * (1.0 - ratio_ * at.error_derivative);
  s.twist_rad = solution.twist_rad;
  s.hysteresis_anchor_rad = model::MovedAnchor(curve.hysteresis, s.twist_rad, s.hysteresis_anchor_rad);
  if (kExtended && curve.deviates) MoveFurtherAnchors();
  s.gear_torque_Nm = solution.torque_Nm + damping_Nms_per_rad_ * slip_speed;
  model::AdvanceCreep(substep_.creep, s.gear_torque_Nm, s.creep_rad);
  if (kExtended && has_exponential_creep_) AdvanceExponentialCreep(step_s);

  const model::OutputGrip grip = Grip();
  const double gripped_Nm = model::ElementTorque(grip.element, s.output_rad, grip.anchor_rad) +
                            specimen_.load.drag_viscous_Nms_per_rad * s.output_speed_rad_per_s;
  s.output_speed_rad_per_s += step_s / specimen_.inertia.output_kgm2 *
                              (DisturbedLoad(commands, at.output_sin) - gripped_Nm - s.gear_torque_Nm);
  s.output_rad += step_s * s.output_speed_rad_per_s;
  s.grip_anchor_rad = model::MovedAnchor(grip.element, s.output_rad, s.grip_anchor_rad);

  double friction_Nm = 0.0;
  if (locked) {
    s.input_rad = held_rad + specimen_.brake.compliance_rad_per_Nm * s.gear_torque_Nm * inverse_ratio_;
    s.input_speed_rad_per_s = 0.0;
    s.motor_torque_Nm = s.servo_integral_Nm = 0.0;
    if (kExtended) delay_.Clear();
  } else {
    const double dry_Nm = model::DryFriction_Nm(friction_, input_speed, s.gear_torque_Nm, at.cos1, at.cos2);
    friction_Nm = InputFriction(dry_Nm, input_speed);
    s.motor_torque_Nm = ServoTorque(commands, step_s);
    double acting_Nm = s.motor_torque_Nm;
    if (kExtended && delay_.delays()) acting_Nm = delay_.Next(acting_Nm, step_s);
    if (kExtended && has_drive_causes_) {
      friction_Nm += ExtraDrag_Nm(input_speed);
      acting_Nm -= ExtraLoad_Nm(s.input_rad);
    }
    const double back_Nm = s.gear_torque_Nm * inverse_ratio_ * (1.0 - ratio_ * at.error_derivative);
    const double net_Nm = acting_Nm - specimen_.servo.cogging_Nm * at.cos8 + back_Nm - friction_Nm;
    s.input_speed_rad_per_s += step_s * net_Nm / specimen_.inertia.input_kgm2;
    s.input_rad += step_s * s.input_speed_rad_per_s;
  }
  Account(s.input_rad - from_rad, friction_Nm, step_s);
}

template void GearPlant::StepQuasiStatic<true>(const PlantCommands&, double) noexcept;
template void GearPlant::StepQuasiStatic<false>(const PlantCommands&, double) noexcept;
template void GearPlant::StepDynamic<true>(const PlantCommands&, double) noexcept;
template void GearPlant::StepDynamic<false>(const PlantCommands&, double) noexcept;

}  // namespace strainwave::bench
