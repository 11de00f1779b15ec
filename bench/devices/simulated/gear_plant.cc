// SPDX-License-Identifier: Apache-2.0
#include "bench/devices/simulated/gear_plant.h"

#include <algorithm>
#include <cmath>

#include "analysis/units.h"
#include "bench/devices/simulated/turn_table.h"

namespace strainwave::bench {

namespace model = analysis::model;

namespace {

constexpr double kLongestQuasiStaticStep_s = 0.1;
constexpr double kSlowPeriod_s = 1.0;

// Brakes bite once the shaft is nearly at rest, the load's brake later than the input's so that the gear
// unwinds before it is locked at both ends; at the latest after the given time.
constexpr double kInputBiteSpeed_rad_per_s = 2.0;
constexpr double kInputLatestBite_s = 0.5;
constexpr double kOutputBiteSpeed_rad_per_s = 0.03;
constexpr double kLoadEarliestBite_s = 0.3;
constexpr double kLoadLatestBite_s = 1.0;

}  // namespace

GearPlant::GearPlant(const model::PlantParameters& specimen)
    : specimen_(specimen), ratio_(specimen.ratio), inverse_ratio_(1.0 / specimen.ratio) {
  const double room = model::AmbientTemperature_degC(specimen_.ambient, 0.0);
  state_.thermal = {room, room, room};
  has_drive_causes_ = specimen_.drive_causes.any_torque();
  has_brake_yield_ = specimen_.brake.yield.any();
  has_exponential_creep_ = specimen_.exponential_creep.compliance_rad_per_Nm != 0.0;
  delay_ = DelayLine(specimen_.drive_causes.delay_s);
  extended_ = has_drive_causes_ || has_brake_yield_ || has_exponential_creep_ || delay_.delays() ||
              specimen_.deviations.any() || specimen_.kinematic.damage.height_rad != 0.0;
  RefreshProperties();
  // The output starts at its encoder's zero, unloaded.
  state_.mount_offset_rad = Evaluate<true>(0.0).error_rad;
}

void GearPlant::SetState(const PlantState& state) noexcept {
  state_ = state;
  measurement_start_s_ = state_.time_s;
  delay_.Clear();
  ratio_ = state_.blank_mounted ? 1.0 : specimen_.ratio;
  inverse_ratio_ = 1.0 / ratio_;
  RefreshProperties();
}

void GearPlant::SetGearTemperature(double temperature_degC) noexcept {
  state_.thermal.gear_degC = temperature_degC;
  RefreshProperties();
}

void GearPlant::MountBlank(bool mounted) noexcept {
  if (mounted == state_.blank_mounted) return;
  state_.blank_mounted = mounted;
  ratio_ = mounted ? 1.0 : specimen_.ratio;
  inverse_ratio_ = 1.0 / ratio_;
  RefreshProperties();
  state_.gear_torque_Nm = 0.0;
  state_.twist_rad = 0.0;
  state_.hysteresis_anchor_rad = 0.0;
  state_.further_anchor_rad = {};
  state_.exponential_creep_rad = 0.0;
  state_.grip_anchor_rad = state_.output_rad;
  state_.friction_anchor_rad = state_.input_rad;
  state_.brake_anchor_rad = state_.input_rad;
  state_.creep_rad = {};
  state_.mount_offset_rad =
      state_.output_rad - state_.input_rad / ratio_ + Evaluate<true>(state_.input_rad).error_rad;
}

bool GearPlant::dynamics_possible() const noexcept {
  return specimen_.has_resonance && !state_.blank_mounted &&
         law_.spring.k1_Nm_per_rad < 0.01 * model::kRigid_Nm_per_rad;
}

void GearPlant::PrepareFactors(StepFactors& factors, double step_s) const noexcept {
  if (factors.step_s == step_s) return;
  factors.step_s = step_s;
  factors.creep = model::MakeCreepStep(specimen_.creep, step_s);
  if (state_.blank_mounted) factors.creep.compliance_rad_per_Nm = 0.0;
  const double lag_s = specimen_.load.torque_lag_s;
  factors.load_lag = lag_s > 0.0 ? -std::expm1(-step_s / lag_s) : 1.0;
  factors.position = -std::expm1(-step_s * specimen_.servo.position_gain_per_s);
}

template <bool kExtended>
GearPlant::AtAngle GearPlant::Evaluate(double input_rad) noexcept {
  const double turns = input_rad * (1.0 / kTwoPi);
  const TurnPhasor input = PhasorAtTurns(turns);
  const TurnPhasor output = PhasorAtTurns(turns * inverse_ratio_);
  const model::GearPhasors phasors{input.sine, input.cosine, output.sine, output.cosine};
  const model::InputHarmonics harmonics = model::HarmonicsOf(phasors);
  const model::KinematicValue error =
      kExtended ? model::EvaluateDamagedKinematicError(kinematic_, phasors, harmonics)
                : model::EvaluateKinematicError(kinematic_, phasors, harmonics);
  electrical_sine_ = harmonics.sin4;
  const double cos8 = 1.0 - 2.0 * harmonics.sin4 * harmonics.sin4;
  return {seating_.kinematic * error.error_rad,
          seating_.kinematic * error.derivative,
          seating_.stiffness * model::StiffnessScale(stiffness_ripple_, harmonics.cos2),
          phasors.input_cos,
          harmonics.cos2,
          cos8,
          phasors.output_sin};
}
template GearPlant::AtAngle GearPlant::Evaluate<true>(double) noexcept;
template GearPlant::AtAngle GearPlant::Evaluate<false>(double) noexcept;

model::OutputGrip GearPlant::Grip() const noexcept {
  const model::LoadTrain& load = specimen_.load;
  if (state_.load_brake_closed) {
    return {{load.brake_holding_Nm, load.brake_holding_Nm / load.brake_stiffness_Nm_per_rad},
            load.brake_stiffness_Nm_per_rad,
            state_.grip_anchor_rad};
  }
  return {{load.drag_Nm, load.drag_presliding_rad},
          load.drag_Nm / load.drag_presliding_rad,
          state_.grip_anchor_rad};
}

void GearPlant::CloseLoadBrake(bool closed) noexcept {
  if (closed == state_.load_brake_closed) return;
  // The torque that grips the output goes on without a jump, as far as the new element can carry it.
  const model::OutputGrip before = Grip();
  const double torque_Nm = model::ElementTorque(before.element, state_.output_rad, before.anchor_rad);
  state_.load_brake_closed = closed;
  const model::ElastoPlasticElement after = Grip().element;
  const double carried = std::clamp(torque_Nm, -after.limit_Nm, after.limit_Nm);
  state_.grip_anchor_rad =
      after.limit_Nm > 0.0 ? state_.output_rad - carried / after.stiffness_Nm_per_rad() : state_.output_rad;
}

void GearPlant::StepBrakes(const PlantCommands& commands, double step_s) noexcept {
  if (commands.input_brake != state_.input_brake_closed) {
    state_.input_brake_wait_s = commands.input_brake ? state_.input_brake_wait_s + step_s : 0.0;
    const bool slow = std::abs(state_.input_speed_rad_per_s) < kInputBiteSpeed_rad_per_s;
    if (!commands.input_brake) {
      state_.input_brake_closed = false;
    } else if (slow || state_.input_brake_wait_s > kInputLatestBite_s) {
      state_.input_brake_closed = true;
      state_.input_brake_wait_s = 0.0;
      state_.input_speed_rad_per_s = 0.0;
      state_.servo_integral_Nm = 0.0;
      const double compliance = state_.blank_mounted ? 0.0 : specimen_.brake.compliance_rad_per_Nm;
      state_.brake_excess_Nm = state_.brake_furthest_excess_Nm = 0.0;
      state_.brake_anchor_rad = state_.input_rad - compliance * state_.gear_torque_Nm * inverse_ratio_;
    }
  }
  if (commands.load_brake != state_.load_brake_closed) {
    const bool input_comes_first = commands.input_brake && !state_.input_brake_closed;
    state_.load_brake_wait_s =
        commands.load_brake && !input_comes_first ? state_.load_brake_wait_s + step_s : 0.0;
    const bool slow = std::abs(state_.output_speed_rad_per_s) < kOutputBiteSpeed_rad_per_s;
    if (!commands.load_brake || (slow && state_.load_brake_wait_s > kLoadEarliestBite_s) ||
        state_.load_brake_wait_s > kLoadLatestBite_s) {
      CloseLoadBrake(commands.load_brake);
      state_.load_brake_wait_s = 0.0;
    }
  }
}

template <bool kExtended>
void GearPlant::StepPieces(const PlantCommands& commands, double step_s) noexcept {
  // Nothing to follow but torques: the speeds that come of them take short steps.
  const bool held = !commands.load_speed_rad_per_s &&
                    (state_.input_brake_closed || commands.input == PlantCommands::Input::kSpeed ||
                     commands.input == PlantCommands::Input::kPosition);
  if (dynamics_possible() && (step_s <= kLongestDynamicStep_s || !held)) {
    StepDynamic<kExtended>(commands, step_s);
  } else {
    const int pieces = step_s > kLongestQuasiStaticStep_s
                           ? static_cast<int>(std::ceil(step_s / kLongestQuasiStaticStep_s))
                           : 1;
    const double piece_s = step_s / pieces;
    for (int piece = 0; piece < pieces; ++piece) StepQuasiStatic<kExtended>(commands, piece_s);
  }
}

void GearPlant::Step(const PlantCommands& commands, double step_s) noexcept {
  StepBrakes(commands, step_s);
  if (extended_) {
    StepPieces<true>(commands, step_s);
  } else {
    StepPieces<false>(commands, step_s);
  }
}

double GearPlant::DisturbedLoad(const PlantCommands& commands, double output_sin) const noexcept {
  const model::LoadTrain& load = specimen_.load;
  double torque_Nm = state_.load_torque_Nm - load.unbalance_Nm * output_sin;
  if (commands.load_enabled) {
    const double ripple_Nm = load.cogging_Nm + load.ripple_share * std::abs(state_.load_torque_Nm);
    torque_Nm += ripple_Nm * TableSine(load.motor_turns_per_output_turn * state_.output_rad * (1.0 / kTwoPi));
  }
  return torque_Nm;
}

double GearPlant::InputFriction(double dry_Nm, double speed_rad_per_s) noexcept {
  const model::ElastoPlasticElement dry{dry_Nm, specimen_.friction.presliding_rad};
  state_.friction_anchor_rad = model::MovedAnchor(dry, state_.input_rad, state_.friction_anchor_rad);
  return model::ElementTorque(dry, state_.input_rad, state_.friction_anchor_rad) +
         friction_.viscous_Nms_per_rad * speed_rad_per_s;
}

double GearPlant::SlipBrake(double step_s) noexcept {
  if (state_.blank_mounted) return 0.0;  // the fixture clamps the blank to the frame
  const double on_brake_Nm = state_.gear_torque_Nm * inverse_ratio_;
  const double beyond_Nm = std::abs(on_brake_Nm) - specimen_.brake.holding_torque_Nm;
  double slip_rad = 0.0;
  if (has_brake_yield_) slip_rad = YieldOfBrake(std::max(0.0, beyond_Nm), step_s);
  if (beyond_Nm <= 0.0) return 0.0;
  slip_rad += beyond_Nm / specimen_.brake.slip_damping_Nms_per_rad * step_s;
  return std::copysign(slip_rad, on_brake_Nm);
}

void GearPlant::Account(double travel_rad, double friction_Nm, double step_s) noexcept {
  const double turns = std::abs(travel_rad) * (1.0 / kTwoPi);
  const double torque = std::abs(state_.gear_torque_Nm);
  if (!state_.blank_mounted) {
    state_.slow_revolutions += turns;
    state_.slow_cubed_Nm3 += torque * torque * torque * turns;
  }
  state_.gear_heat_J += std::abs(friction_Nm * travel_rad);
  state_.motor_heat_J +=
      specimen_.thermal.motor_loss_W_per_Nm2 * state_.motor_torque_Nm * state_.motor_torque_Nm * step_s;
  state_.time_s += step_s;
  state_.slow_elapsed_s += step_s;
  if (state_.slow_elapsed_s >= kSlowPeriod_s) UpdateSlowStates();
}

void GearPlant::UpdateSlowStates() noexcept {
  const double step_s = state_.slow_elapsed_s;
  room_degC_ = model::AmbientTemperature_degC(specimen_.ambient, state_.time_s);
  model::AdvanceThermal(specimen_.thermal, {state_.gear_heat_J / step_s, state_.motor_heat_J / step_s},
                        room_degC_, step_s, state_.thermal);
  model::AdvanceWear(specimen_.wear,
                     {state_.slow_revolutions, state_.slow_cubed_Nm3, state_.thermal.gear_degC}, state_.wear);
  state_.input_revolutions += state_.slow_revolutions;
  state_.cubed_torque_revolutions_Nm3 += state_.slow_cubed_Nm3;
  state_.slow_elapsed_s = 0.0;
  state_.gear_heat_J = 0.0;
  state_.motor_heat_J = 0.0;
  state_.slow_revolutions = 0.0;
  state_.slow_cubed_Nm3 = 0.0;
  RefreshProperties();
}

void GearPlant::RefreshProperties() noexcept {
  room_degC_ = model::AmbientTemperature_degC(specimen_.ambient, state_.time_s);
  law_.series_compliance_rad_per_Nm = specimen_.series.total_rad_per_Nm();
  if (state_.blank_mounted) {
    law_.spring = {model::kRigid_Nm_per_rad, model::kRigid_Nm_per_rad, model::kRigid_Nm_per_rad, 7.0, 25.0};
    law_.hysteresis = {0.0, 1.0};
    law_.deviations = {};
    kinematic_ = {};
    kinematic_.inverse_ratio = inverse_ratio_;
    friction_ = {};
    stiffness_ripple_ = 0.0;
  } else {
    const model::WearFactors worn = model::FactorsOf(specimen_.wear_effects, state_.wear);
    law_.spring = specimen_.spring;
    // A spring that is switched off does not become soft by wear.
    if (specimen_.spring.k1_Nm_per_rad < model::kRigid_Nm_per_rad) {
      law_.spring.k1_Nm_per_rad *= worn.k1;
      law_.spring.k2_Nm_per_rad *= worn.k2;
      law_.spring.k3_Nm_per_rad *= worn.k3;
    }
    law_.hysteresis = specimen_.hysteresis;
    law_.hysteresis.limit_Nm *= worn.hysteresis;
    law_.deviations = specimen_.deviations;
    model::KinematicError error = specimen_.kinematic;
    for (std::size_t k = 0; k < model::kKinematicOrders; ++k) error.amplitude_rad[k] *= worn.kinematic[k];
    kinematic_ = model::CompileKinematicError(error, ratio_);
    // The misaligned coupling turns the wave generator by (b²/4)·sin 2θ; the output sees 1/N of that.
    kinematic_.sine_rad[1] -=
        model::CouplingErrorAmplitude_rad(specimen_.servo.coupling_misalignment_rad) / ratio_;
    model::Friction friction = specimen_.friction;
    friction.coulomb_Nm *= worn.coulomb;
    friction.breakaway_Nm *= worn.coulomb;
    friction.viscous_at_0_degC_Nms_per_rad *= worn.viscous;
    friction.load_coefficient *= worn.load_friction;
    friction.flexspline_Nm *= worn.flexspline_loss;
    friction.flexspline_load_coefficient *= worn.flexspline_loss;
    friction_ = model::AtTemperature(friction, state_.thermal.gear_degC, measurement_time_s());
    stiffness_ripple_ = specimen_.stiffness_ripple;
  }
  damping_Nms_per_rad_ = ShortStepDamping();
  free_curve_ = locked_curve_ = model::CurveOf(law_);
  if (!state_.blank_mounted) {
    locked_curve_.series_compliance_rad_per_Nm += specimen_.brake.compliance_rad_per_Nm / (ratio_ * ratio_);
  }
  quasi_static_.step_s = substep_.step_s = -1.0;
}

}  // namespace strainwave::bench
