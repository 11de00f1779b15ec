// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstddef>
#include <mutex>
#include <string>
#include <vector>

#include "bench/devices/modbus/modbus_servo_profile.h"

namespace strainwave::bench {

/// The inside of a servo drive on Modbus: control word, status, set points, brake and watchdog over the
/// registers of a profile. Without inertia: what is commanded is at once actual. From any thread.
class ModbusServoModel {
 public:
  /// What keeps the watchdog quiet. Only the first is right.
  enum class Watchdog { kWrites, kAnything, kNever };

  ModbusServoModel(protocols::modbus::RegisterMap map, const ModbusServoProfile& profile);

  double Read(std::size_t index, std::chrono::nanoseconds now);
  bool Write(std::size_t index, double value, std::chrono::nanoseconds now);
  /// A request of any kind came in.
  void Hear(std::chrono::nanoseconds now);

  void set_watchdog(Watchdog watchdog);
  /// The time that is kept whatever is written; below zero: that which is written.
  void set_fixed_watchdog_time(double time_s);
  void Fault();

  protocols::PowerState power(std::chrono::nanoseconds now);
  bool brake_engaged();
  double actual_speed_rad_per_s(std::chrono::nanoseconds now);
  /// All that was written since the last call, in order: "control 1", "brake 0".
  std::vector<std::string> TakeWritten();

 private:
  void Supervise(std::chrono::nanoseconds now);
  double StatusNumber() const;
  double Speed() const;
  double Torque() const;

  const protocols::modbus::RegisterMap map_;
  const ModbusServoProfile profile_;
  const ModbusServoRegisters at_;
  std::mutex mutex_;
  std::vector<double> written_;  // a register: what it holds
  protocols::PowerState power_{protocols::PowerState::kSwitchOnDisabled};
  Watchdog watchdog_{Watchdog::kWrites};
  double fixed_watchdog_time_s_{-1};
  std::chrono::nanoseconds fed_{};
  std::vector<std::string> log_;
};

}  // namespace strainwave::bench
