// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "analysis/model/creep.h"
#include "analysis/model/thermal.h"
#include "analysis/model/wear.h"

namespace strainwave::bench {

/// The whole state of the plant. Trivially copyable: it is what a power cut leaves behind.
struct PlantState {
  double time_s{};  // simulated, since the bench was new
  // Motion. Positive is clockwise seen from the output; input angle / ratio runs with the output angle.
  double input_rad{};
  double input_speed_rad_per_s{};
  double output_rad{};
  double output_speed_rad_per_s{};
  // Torques: through the gear, positive twists the output forward against the input; of the servos.
  double gear_torque_Nm{};
  double motor_torque_Nm{};
  double load_torque_Nm{};
  double servo_integral_Nm{};
  // Elastic and frictional elements.
  double twist_rad{};
  double hysteresis_anchor_rad{};
  std::array<double, 2> further_anchor_rad{};  // of the further friction elements
  double grip_anchor_rad{};
  double friction_anchor_rad{};
  double brake_anchor_rad{};
  double brake_excess_Nm{};           // beyond what it holds, at the last step
  double brake_furthest_excess_Nm{};  // since it closed
  double mount_offset_rad{};          // output angle at input zero, no load, no error
  analysis::model::CreepState creep_rad{};
  double exponential_creep_rad{};
  // Brakes: closed is what the mechanics do, some time after the command.
  bool input_brake_closed{true};
  bool load_brake_closed{true};
  double input_brake_wait_s{};
  double load_brake_wait_s{};
  bool blank_mounted{};
  // Slow states.
  analysis::model::ThermalState thermal;
  analysis::model::WearState wear;
  double input_revolutions{};
  double cubed_torque_revolutions_Nm3{};
  // Since the slow states were last moved on.
  double slow_elapsed_s{};
  double gear_heat_J{};
  double motor_heat_J{};
  double slow_revolutions{};
  double slow_cubed_Nm3{};
};

}  // namespace strainwave::bench
