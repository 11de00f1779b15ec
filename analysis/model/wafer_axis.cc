// SPDX-License-Identifier: Apache-2.0
#include "analysis/model/wafer_axis.h"

#include <algorithm>
#include <cmath>
#include <random>

#include "analysis/units.h"

namespace strainwave::analysis::model {
namespace {

constexpr double kStep_s = 1.0 / kWaferVibrationRate_hz;

// Box and Muller, the same bits on every machine.
class NormalNoise {
 public:
  explicit NormalNoise(std::uint64_t seed) : engine_(seed) {}
  double Next() {
    if (has_spare_) {
      has_spare_ = false;
      return spare_;
    }
    const double radius = std::sqrt(-2.0 * std::log(Even()));
    const double angle = kTwoPi * Even();
    spare_ = radius * std::sin(angle);
    has_spare_ = true;
    return radius * std::cos(angle);
  }

 private:
  double Even() { return (static_cast<double>(engine_() >> 11U) + 0.5) * 0x1p-53; }
  std::mt19937_64 engine_;
  double spare_{};
  bool has_spare_{};
};

// Position, speed and acceleration of the command: a quintic from rest to rest (least jerk).
struct Command {
  double share{};  // of the way
  double rate_per_s{};
  double second_per_s2{};
};
Command MoveAt(double since_s, double move_s) {
  if (since_s <= 0.0) return {};
  if (since_s >= move_s) return {1.0, 0.0, 0.0};
  const double u = since_s / move_s;
  return {u * u * u * (10.0 + u * (-15.0 + 6.0 * u)), 30.0 * u * u * (1.0 - u) * (1.0 - u) / move_s,
          60.0 * u * (1.0 - u) * (1.0 - 2.0 * u) / (move_s * move_s)};
}

Command CommandAt(const WaferMotion& motion, double time_s) {
  const Command out = MoveAt(time_s - motion.first_start_s, motion.move_s);
  const Command back = MoveAt(time_s - motion.second_start_s, motion.move_s);
  return {out.share - back.share, out.rate_per_s - back.rate_per_s, out.second_per_s2 - back.second_per_s2};
}

// The share of worn teeth where they are in mesh, softly. Two lobes meet them for twice their share of a
// turn.
double WornTeeth(const WaferAxis& axis, double relative_rad) {
  if (axis.worn_share <= 0.0) return 0.0;
  constexpr double kEdge = 2.0;
  const double duty = std::min(0.95, 2.0 * axis.worn_share);
  const double lobe = std::cos(2.0 * relative_rad + axis.worn_phase_rad) - std::cos(kPi * duty);
  return axis.worn_share * (0.5 + 0.5 * std::tanh(kEdge * lobe));
}

struct BeltAt {
  double error_rad;
  double damage;  // 0 to 1
};
BeltAt BeltTeeth(const WaferAxis& axis, double teeth) {
  const double phase = kTwoPi * teeth;
  const double cosine = std::cos(phase);
  BeltAt at{axis.belt_tooth_error_rad * cosine, 0.0};
  if (axis.damaged_belt_teeth == 0) return at;
  const double count = axis.damaged_belt_teeth;
  constexpr double kEdge_teeth = 0.3;
  at.damage = 0.5 * (std::tanh((teeth + 0.5) / kEdge_teeth) - std::tanh((teeth - count - 0.5) / kEdge_teeth));
  // A sound tooth beside carries for a damaged one; where all are damaged, none does.
  at.damage *= std::pow(count / kMeshingBeltTeeth, 0.8);
  constexpr double kSharp = 60.0;
  at.error_rad += axis.damaged_tooth_error_rad * at.damage * std::exp(kSharp * (cosine - 1.0));
  return at;
}

// A bending mode in m/s² of its driving acceleration.
struct Mode {
  double frequency_rad_per_s;
  double damping;
  double share;
  double position{};
  double speed{};

  double Step(double drive) {
    const double acceleration = drive - 2.0 * damping * frequency_rad_per_s * speed -
                                frequency_rad_per_s * frequency_rad_per_s * position;
    speed += kStep_s * acceleration;
    position += kStep_s * speed;
    return share * acceleration;
  }
};

}  // namespace

WaferCycle SimulateWaferCycle(const WaferAxis& axis, const WaferMotion& motion, const WaferNoise& noise,
                              std::uint64_t seed) {
  NormalNoise random(seed);
  const FrictionAtTemperature friction = AtTemperature(axis.friction, axis.temperature_degC);
  const SpringCurve curve = CurveOf(axis.spring);
  const KinematicSeries series = CompileKinematicError(axis.kinematic_error, axis.ratio);
  const double inverse_ratio = 1.0 / axis.ratio;
  const double way_rad = motion.angle_rad * axis.ratio;
  const double inertia = axis.rotor_inertia_kgm2 +
                         (axis.arm_inertia_kgm2 + axis.pulley_inertia_kgm2) * inverse_ratio * inverse_ratio;
  Mode modes[] = {{kTwoPi * 62.0, 0.02, 0.6}, {kTwoPi * 190.0, 0.015, 0.4}};

  double motor_rad = 0.0, motor_speed = 0.0, pulley_rad = 0.0, pulley_speed = 0.0, arm_rad = 0.0,
         arm_speed = 0.0;
  double integral = 0.0, wanted_A = 0.0, current_A = 0.0, squares = 0.0;
  double last_motor_speed = 0.0, last_current = 0.0;
  WaferCycle cycle;
  const auto samples = static_cast<std::size_t>(motion.cycle_s * kWaferMotorRate_hz + 0.5);
  const auto steps = static_cast<std::size_t>(motion.cycle_s * kWaferVibrationRate_hz + 0.5);
  std::size_t next_sample = 0;
  for (std::size_t step = 0; step <= steps && next_sample < samples; ++step) {
    const double time_s = static_cast<double>(step) * kStep_s;
    const double due_s = static_cast<double>(next_sample) / kWaferMotorRate_hz;
    if (time_s >= due_s) {
      // Between two steps, in proportion.
      const double before = std::clamp((time_s - due_s) / kStep_s, 0.0, 1.0);
      const double speed = motor_speed + before * (last_motor_speed - motor_speed);
      const double current = current_A + before * (last_current - current_A);
      const Command command = CommandAt(motion, due_s);
      cycle.current_A.push_back(current + noise.current_A * random.Next());
      cycle.velocity_rad_per_s.push_back(speed + noise.velocity_rad_per_s * random.Next());
      cycle.state.push_back(command.rate_per_s != 0.0 ? 1.0 : 0.0);
      const double off_rad = way_rad * command.share - motor_rad;
      const double off_speed = way_rad * command.rate_per_s + axis.position_gain_per_s * off_rad - speed;
      integral += off_speed / kWaferMotorRate_hz;
      const double torque = inertia * way_rad * command.second_per_s2 +
                            axis.speed_gain_Nms_per_rad * off_speed +
                            axis.speed_integral_Nm_per_rad * integral;
      wanted_A =
          std::clamp(torque / axis.torque_constant_Nm_per_A, -axis.current_limit_A, axis.current_limit_A);
      ++next_sample;
    }
    last_motor_speed = motor_speed;
    last_current = current_A;
    current_A += kStep_s / axis.current_loop_s * (wanted_A - current_A);

    const GearPhasors phasors = PhasorsAt(motor_rad, inverse_ratio);
    const KinematicValue kinematic = EvaluateKinematicError(series, phasors, HarmonicsOf(phasors));
    const double worn = WornTeeth(axis, motor_rad + pulley_rad);
    const double twist =
        motor_rad * inverse_ratio - kinematic.error_rad - axis.worn_error_rad * worn - pulley_rad;
    const double gear_Nm = (1.0 - axis.worn_softening * worn) * EvaluateSpring(curve, twist).torque_Nm +
                           axis.spring_damping_Nms_per_rad * (motor_speed * inverse_ratio - pulley_speed);
    const BeltAt belt = BeltTeeth(axis, kMeshingBeltTeeth * pulley_rad / motion.angle_rad);
    const double play = 0.5 * (axis.belt_play_rad + axis.damaged_play_rad * belt.damage);
    const double elongation_rad = pulley_rad - belt.error_rad - arm_rad;
    const double taut = elongation_rad - std::clamp(elongation_rad, -play, play);
    const double belt_Nm =
        (1.0 - axis.damaged_softening * belt.damage) * axis.belt_stiffness_Nm_per_rad * taut +
        axis.belt_damping_Nms_per_rad * (pulley_speed - arm_speed);
    // What cut teeth carry: the belt's torque, and more while the gear gives way in jerks.
    const double tooth_load_Nm = belt.damage * std::abs(belt_Nm) * (1.0 + axis.worn_jerk * worn);
    cycle.most_tooth_load_Nm = std::max(cycle.most_tooth_load_Nm, tooth_load_Nm);
    if (tooth_load_Nm > axis.belt_holds_Nm) {
      cycle.failed = true;
      break;
    }
    const double phasor2 = phasors.input_cos * phasors.input_cos - phasors.input_sin * phasors.input_sin;
    const double dry = DryFriction_Nm(friction, motor_speed, gear_Nm, phasors.input_cos, phasor2);
    constexpr double kSlip_rad_per_s = 0.6;
    const double friction_Nm =
        dry * std::tanh(motor_speed / kSlip_rad_per_s) + friction.viscous_Nms_per_rad * motor_speed;
    const double motor_Nm = axis.torque_constant_Nm_per_A * current_A - friction_Nm -
                            gear_Nm * (inverse_ratio - kinematic.derivative);
    motor_speed += kStep_s * motor_Nm / axis.rotor_inertia_kgm2;
    const double pulley_acceleration = (gear_Nm - belt_Nm) / axis.pulley_inertia_kgm2;
    pulley_speed += kStep_s * pulley_acceleration;
    arm_speed += kStep_s * belt_Nm / axis.arm_inertia_kgm2;
    motor_rad += kStep_s * motor_speed;
    pulley_rad += kStep_s * pulley_speed;
    arm_rad += kStep_s * arm_speed;

    double vertical = noise.vertical_m_per_s2 * random.Next();
    const double drive =
        axis.vertical_gain_per_kgm * (1.0 + axis.damaged_lift * belt.damage) * (gear_Nm + belt_Nm);
    for (Mode& mode : modes) vertical += mode.Step(drive);
    squares += vertical * vertical;
  }
  cycle.vertical_rms_m_per_s2 = std::sqrt(squares / static_cast<double>(std::max<std::size_t>(1, steps)));
  return cycle;
}

}  // namespace strainwave::analysis::model
