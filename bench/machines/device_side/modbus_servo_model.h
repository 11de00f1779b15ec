// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstddef>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "bench/devices/modbus/modbus_servo_profile.h"
#include "bench/roles/servo_drive.h"

namespace strainwave::bench {

/// The inside of a servo drive on Modbus: control word, status, set points, brake and watchdog over the
/// registers of a profile. Without inertia, what is commanded is at once actual, until `Turn` gives it a
/// motor. A stop takes the torque off at once; in a fault the brake is on, else it is as written. From any
/// thread.
class ModbusServoModel {
 public:
  /// What keeps the watchdog quiet. Only the first is right.
  enum class Watchdog { kWrites, kAnything, kNever };

  /// What is wrong with it, until it is set otherwise.
  struct Faults {
    bool enable_input_open{};              // it drops out without a fault, and cannot be enabled
    std::optional<double> stuck_status{};  // reads as this, whatever is so
    bool count_stuck{};                    // the watchdog register reads what it read before
    bool brake_inverted{};                 // reads back as the opposite
    bool actual_stuck{};                   // speed, torque and position read what they read before
  };

  ModbusServoModel(protocols::modbus::RegisterMap map, const ModbusServoProfile& profile);

  double Read(std::size_t index, std::chrono::nanoseconds now);
  bool Write(std::size_t index, double value, std::chrono::nanoseconds now);
  /// A request of any kind came in.
  void Hear(std::chrono::nanoseconds now);

  /// Has `motor` do what was written, and takes what that does for what is actual: once a step of the motor.
  /// @param reducer_ratio  turns of the shaft that the registers speak of for one of the motor's
  ///   `ServoDrive`.
  void Turn(ServoDrive& motor, double reducer_ratio, std::chrono::nanoseconds now);

  void set_watchdog(Watchdog watchdog);
  /// The time that is kept whatever is written; below zero: that which is written.
  void set_fixed_watchdog_time(double time_s);
  void set_faults(const Faults& faults);
  Faults faults();
  void Fault();
  /// As after a dip of its supply: off, braked, and all that was written is gone, the watchdog time included.
  void Restart();

  protocols::PowerState power(std::chrono::nanoseconds now);
  bool brake_engaged();
  double actual_speed_rad_per_s(std::chrono::nanoseconds now);
  /// All that was written since the last call, in order: "control 1", "brake 0".
  std::vector<std::string> TakeWritten();

 private:
  struct Actual {
    double speed_rad_per_s{};
    double torque_Nm{};
    double position_rad{};
  };

  void Supervise(std::chrono::nanoseconds now);
  void EnterFault();
  double StatusNumber() const;
  Actual ActualNow() const;
  double PositionRegister(double position_rad) const;

  const protocols::modbus::RegisterMap map_;
  const ModbusServoProfile profile_;
  const ModbusServoRegisters at_;
  std::mutex mutex_;
  std::vector<double> written_;  // a register: what it holds
  protocols::PowerState power_{protocols::PowerState::kSwitchOnDisabled};
  std::optional<DriveMode> turns_in_;  // the motor; nothing: it is off
  std::optional<DriveActual> motor_;   // at the shaft of the registers
  Watchdog watchdog_{Watchdog::kWrites};
  double fixed_watchdog_time_s_{-1};
  Faults faults_;
  double stuck_count_{};
  Actual stuck_actual_;
  std::chrono::nanoseconds fed_{};
  std::vector<std::string> log_;
};

}  // namespace strainwave::bench
