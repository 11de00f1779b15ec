// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "protocols/cia402.h"
#include "protocols/modbus/register_map.h"

namespace strainwave::bench {

/// What a servo drive's registers mean, by their names in its map:
///
///   control           written: one of `control`
///   status            read: its bits, by `status`
///   mode              written: `speed_mode` or `torque_mode`
///   speed_set_point   written, rad/s          torque_set_point  written, N·m
///   actual_speed      read, rad/s             actual_torque     read, N·m
///   actual_position   read, rad; may be left out
///   brake             written and read: `brake_engaged` or `brake_released`
///   product_code, serial_number   read once a connection, for people; may be left out
///   fault_code        read, for people; may be left out
///   watchdog_time     written and read, s: how long the drive goes on without a write
///   watchdog          written: a number that counts up each period; may be left out where every write will
///   do
struct ModbusServoProfile {
  struct Control {
    double off{}, enable{}, quick_stop{}, reset_fault{};
  };
  /// A state that is in force when the status bits under `mask` are `value`; the first row that fits counts.
  struct Status {
    std::uint32_t mask{}, value{};
    protocols::PowerState state{};
  };
  /// Of a servo with a reducer the shaft that the registers of torque, speed and position speak of.
  enum class Shaft { kMotor, kOutput };
  Shaft shaft{};
  Control control;
  std::vector<Status> status;
  double speed_mode{}, torque_mode{};
  double brake_engaged{}, brake_released{};
  std::chrono::nanoseconds period{};         // between two writes
  std::chrono::nanoseconds watchdog_time{};  // that the drive is given
};

/// Where the registers of a servo drive stand in its map.
struct ModbusServoRegisters {
  std::size_t control{}, status{}, mode{}, speed_set_point{}, torque_set_point{}, actual_speed{},
      actual_torque{}, brake{}, watchdog_time{};
  std::optional<std::size_t> actual_position, watchdog, product_code, serial_number, fault_code;
};

/// The map as seen from the output of the servo's reducer: where the registers speak of the motor, torque is
/// multiplied by `reducer_ratio`, speed and position are divided by it, with their bounds.
/// @param reducer_ratio  motor over output, above zero.
protocols::modbus::RegisterMap AtAxis(protocols::modbus::RegisterMap map, const ModbusServoProfile& profile,
                                      double reducer_ratio);

/// The largest magnitude that a set point's register takes in both directions, by its type and its bounds.
double LargestSetPoint(const protocols::modbus::Register& value);

/// What is missing or contradicts itself for a servo drive, one line each; empty when it can be used.
std::vector<std::string> CheckServoProfile(const protocols::modbus::RegisterMap& map,
                                           const ModbusServoProfile& profile);

/// @throws std::invalid_argument with all that CheckServoProfile finds.
ModbusServoRegisters FindServoRegisters(const protocols::modbus::RegisterMap& map,
                                        const ModbusServoProfile& profile);

/// "in fault, code 17 (11h)", as a maker's manual may have it in either notation.
/// @param code  a NaN where it is not known.
std::string FaultWords(double code);

}  // namespace strainwave::bench
