// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

#include "protocols/canopen/object_dictionary.h"

namespace strainwave::protocols::canopen::device {

/// Modes of operation by the numbers of 6060h and 6061h; of 6502h mode n has bit n - 1.
enum class DriveMode : std::int8_t {
  kNone = 0,
  kProfilePosition = 1,
  kProfileVelocity = 3,
  kTorque = 4,
  kHoming = 6,
  kCyclicPosition = 8,
  kCyclicVelocity = 9,
  kCyclicTorque = 10,
};

/// The mode of this number; nothing for one that this drive does not know.
std::optional<DriveMode> DriveModeOf(std::int64_t number);

/// The objects of CiA 402-2 that a drive works with, found once.
/// Position unit: 6092h:1 of them make 6092h:2 turns of the driven shaft, 6091h:1 turns of the motor make
/// 6091h:2 of the shaft, 608Fh:1 increments make 608Fh:2 turns of the motor. Speeds are position units a
/// second, but 6080h is in turns of the motor a minute. Torques are per mille of 6076h.
struct DriveObjects {
  /// @throws std::invalid_argument when one is missing.
  explicit DriveObjects(ObjectDictionary& objects);

  bool Supports(DriveMode mode) const;
  double inc_per_unit() const;
  /// The lower of 607Fh and 6080h, in units a second.
  double speed_limit() const;
  /// 60C2h: how long after a target of a cyclic mode the next one comes.
  double interpolation_s() const;

  Object &abort_option, &error_code, &controlword, &statusword;
  Object &quick_stop_option, &halt_option, &fault_reaction_option;
  Object &mode, &mode_display, &supported_modes;
  Object &position_demand, &position_actual, &following_window, &following_time, &position_window,
      &position_time, &following_error;
  Object &speed_demand, &speed_actual, &speed_window, &speed_time, &standstill_speed;
  Object &target_torque, &torque_limit, &torque_demand, &torque_actual, &torque_slope;
  Object &target_position, &home_offset, &most_profile_speed, &most_motor_speed_rpm, &profile_speed,
      &acceleration, &deceleration, &quick_stop_deceleration;
  Object &encoder_increments, &encoder_turns, &gear_motor, &gear_shaft, &feed, &feed_turns;
  Object &inputs, &outputs, &outputs_mask;
  Object &interpolation_value, &interpolation_exponent;
  Object& target_speed;
};

}  // namespace strainwave::protocols::canopen::device
