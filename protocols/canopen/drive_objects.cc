// SPDX-License-Identifier: Apache-2.0
#include "protocols/canopen/drive_objects.h"

#include <algorithm>
#include <cmath>

namespace strainwave::protocols::canopen::device {
namespace {

// Of a denominator that somebody set to zero the drive makes one.
double Value(const Object& object) {
  return static_cast<double>(std::max<std::int64_t>(object.integer(), 1));
}

}  // namespace

std::optional<DriveMode> DriveModeOf(std::int64_t number) {
  if (number < 0 || number > 10) return std::nullopt;
  const auto mode = static_cast<DriveMode>(number);
  switch (mode) {
    case DriveMode::kNone:
    case DriveMode::kProfilePosition:
    case DriveMode::kProfileVelocity:
    case DriveMode::kTorque:
    case DriveMode::kHoming:
    case DriveMode::kCyclicPosition:
    case DriveMode::kCyclicVelocity:
    case DriveMode::kCyclicTorque:
      return mode;
  }
  return std::nullopt;
}

DriveObjects::DriveObjects(ObjectDictionary& objects)
    : abort_option(objects.At({0x6007, 0})),
      error_code(objects.At({0x603F, 0})),
      controlword(objects.At({0x6040, 0})),
      statusword(objects.At({0x6041, 0})),
      quick_stop_option(objects.At({0x605A, 0})),
      halt_option(objects.At({0x605D, 0})),
      fault_reaction_option(objects.At({0x605E, 0})),
      mode(objects.At({0x6060, 0})),
      mode_display(objects.At({0x6061, 0})),
      supported_modes(objects.At({0x6502, 0})),
      position_demand(objects.At({0x6062, 0})),
      position_actual(objects.At({0x6064, 0})),
      following_window(objects.At({0x6065, 0})),
      following_time(objects.At({0x6066, 0})),
      position_window(objects.At({0x6067, 0})),
      position_time(objects.At({0x6068, 0})),
      following_error(objects.At({0x60F4, 0})),
      speed_demand(objects.At({0x606B, 0})),
      speed_actual(objects.At({0x606C, 0})),
      speed_window(objects.At({0x606D, 0})),
      speed_time(objects.At({0x606E, 0})),
      standstill_speed(objects.At({0x606F, 0})),
      target_torque(objects.At({0x6071, 0})),
      torque_limit(objects.At({0x6072, 0})),
      torque_demand(objects.At({0x6074, 0})),
      torque_actual(objects.At({0x6077, 0})),
      torque_slope(objects.At({0x6087, 0})),
      target_position(objects.At({0x607A, 0})),
      home_offset(objects.At({0x607C, 0})),
      most_profile_speed(objects.At({0x607F, 0})),
      most_motor_speed_rpm(objects.At({0x6080, 0})),
      profile_speed(objects.At({0x6081, 0})),
      acceleration(objects.At({0x6083, 0})),
      deceleration(objects.At({0x6084, 0})),
      quick_stop_deceleration(objects.At({0x6085, 0})),
      encoder_increments(objects.At({0x608F, 1})),
      encoder_turns(objects.At({0x608F, 2})),
      gear_motor(objects.At({0x6091, 1})),
      gear_shaft(objects.At({0x6091, 2})),
      feed(objects.At({0x6092, 1})),
      feed_turns(objects.At({0x6092, 2})),
      inputs(objects.At({0x60FD, 0})),
      outputs(objects.At({0x60FE, 1})),
      outputs_mask(objects.At({0x60FE, 2})),
      interpolation_value(objects.At({0x60C2, 1})),
      interpolation_exponent(objects.At({0x60C2, 2})),
      target_speed(objects.At({0x60FF, 0})) {}

bool DriveObjects::Supports(DriveMode which) const {
  if (which == DriveMode::kNone) return true;
  return (supported_modes.integer() >> (static_cast<int>(which) - 1) & 1) != 0;
}

double DriveObjects::inc_per_unit() const {
  const double inc_per_motor_turn = Value(encoder_increments) / Value(encoder_turns);
  const double motor_turns_per_shaft_turn = Value(gear_motor) / Value(gear_shaft);
  const double units_per_shaft_turn = Value(feed) / Value(feed_turns);
  return inc_per_motor_turn * motor_turns_per_shaft_turn / units_per_shaft_turn;
}

double DriveObjects::speed_limit() const {
  const double inc_per_motor_turn = Value(encoder_increments) / Value(encoder_turns);
  const double motor =
      static_cast<double>(most_motor_speed_rpm.integer()) / 60.0 * inc_per_motor_turn / inc_per_unit();
  return std::min(motor, static_cast<double>(most_profile_speed.integer()));
}

double DriveObjects::interpolation_s() const {
  return static_cast<double>(interpolation_value.integer()) *
         std::pow(10.0, static_cast<double>(interpolation_exponent.integer()));
}

}  // namespace strainwave::protocols::canopen::device
