// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "analysis/model/friction.h"
#include "analysis/model/kinematic_error.h"
#include "analysis/model/torsion_spring.h"

namespace strainwave::analysis::model {

/// One rotary axis of a wafer robot (docs/sources.md#lee-2023, section 3): motor with its controller,
/// harmonic drive, pulley, timing belt, arm. Three inertias, stepped at 25.6 kHz.
///
/// Worn teeth of the flexspline are met twice a turn of the wave generator, for a share of the turn: there
/// the teeth give way and the transmission error has a bump. The 21 teeth of the belt that are in mesh pass
/// to and fro once a cycle each: over those that are damaged the belt is softer, has more play, and each
/// tooth passes with an impact. Both are simple descriptions of ours; their sizes are general knowledge,
/// tuned to what the source says of its signals.
struct WaferAxis {
  // Motor and controller.
  double rotor_inertia_kgm2{4.0e-5};  // with the wave generator
  double torque_constant_Nm_per_A{0.13};
  double current_limit_A{9.0};
  double current_loop_s{4.0e-4};  // first-order lag
  double position_gain_per_s{60.0};
  double speed_gain_Nms_per_rad{0.013};
  double speed_integral_Nm_per_rad{0.5};
  Friction friction{};
  double temperature_degC{30.0};
  // Harmonic drive.
  double ratio{50.0};
  TorsionSpring spring{
      .k1_Nm_per_rad = 6.5e3, .k2_Nm_per_rad = 8.5e3, .k3_Nm_per_rad = 9.5e3, .t1_Nm = 4.0, .t2_Nm = 14.0};
  double spring_damping_Nms_per_rad{0.35};
  KinematicError kinematic_error{};
  double worn_share{};            // of the flexspline's teeth, below 1/2
  double worn_phase_rad{};        // where on its turn
  double worn_error_rad{3.0e-3};  // bump of the transmission error over worn teeth, times their share
  double worn_softening{1.0};     // share of the stiffness that they lack, times their share
  // Pulley, belt and arm.
  double pulley_inertia_kgm2{1.5e-3};
  double belt_stiffness_Nm_per_rad{2.6e3};
  double belt_damping_Nms_per_rad{2.2};
  double belt_play_rad{1.0e-4};
  double belt_tooth_error_rad{2.0e-5};
  int damaged_belt_teeth{};  // of 21
  double damaged_tooth_error_rad{7.0e-4};
  double damaged_softening{0.12};
  double damaged_lift{0.3};  // a belt that rides up on cut teeth bends the arm more, by this share
  double damaged_play_rad{6.0e-4};
  double worn_jerk{2.0};  // of a gear with worn teeth, times their share: more load on the belt's cut teeth
  double belt_holds_Nm{16.3};  // with its shocks; beyond, a damaged belt skips a tooth
  double arm_inertia_kgm2{0.32};
  // From torques in the drive train to the vertical acceleration of the end effector: two bending modes.
  double vertical_gain_per_kgm{0.07};
};

/// A cycle: rest, to a port, rest, back, rest.
struct WaferMotion {
  double angle_rad{1.2};  // of the arm
  double first_start_s{0.4};
  double second_start_s{1.7};
  double move_s{0.5};
  double cycle_s{2.4};
};

struct WaferNoise {
  double current_A{0.012};
  double velocity_rad_per_s{0.03};
  double vertical_m_per_s2{0.03};
};

inline constexpr double kWaferMotorRate_hz = 1000.0;
inline constexpr double kWaferVibrationRate_hz = 25600.0;
inline constexpr int kMeshingBeltTeeth = 21;

struct WaferCycle {
  // At 1 kHz, of the motor.
  std::vector<double> current_A;
  std::vector<double> velocity_rad_per_s;
  std::vector<double> state;       // 1 while the axis is commanded to move
  double vertical_rms_m_per_s2{};  // at 25.6 kHz, over the whole cycle
  double most_tooth_load_Nm{};     // of damaged belt teeth
  bool failed{};                   // the belt has skipped a tooth: the controller stops with an error
};

/// @param seed  of the sensors' noise.
WaferCycle SimulateWaferCycle(const WaferAxis& axis, const WaferMotion& motion, const WaferNoise& noise,
                              std::uint64_t seed);

}  // namespace strainwave::analysis::model
