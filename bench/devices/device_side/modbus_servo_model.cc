// SPDX-License-Identifier: Apache-2.0
#include "bench/devices/device_side/modbus_servo_model.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace strainwave::bench {

using protocols::PowerState;
using std::chrono::nanoseconds;

ModbusServoModel::ModbusServoModel(protocols::modbus::RegisterMap map, const ModbusServoProfile& profile)
    : map_(std::move(map)),
      profile_(profile),
      at_(FindServoRegisters(map_, profile_)),
      written_(map_.registers.size()) {
  written_[at_.brake] = profile.brake_engaged;
}

void ModbusServoModel::Supervise(nanoseconds now) {
  const std::chrono::duration<double> quiet = now - fed_;
  const double time_s = written_[at_.watchdog_time];
  if (watchdog_ == Watchdog::kNever || time_s <= 0 || power_ != PowerState::kOperationEnabled) return;
  if (quiet.count() <= time_s) return;
  power_ = PowerState::kFault;
  written_[at_.brake] = profile_.brake_engaged;
}

double ModbusServoModel::StatusNumber() const {
  const auto row = std::ranges::find(profile_.status, power_, &ModbusServoProfile::Status::state);
  return row == profile_.status.end() ? 0.0 : row->value;
}

double ModbusServoModel::Speed() const {
  const bool turns = power_ == PowerState::kOperationEnabled && written_[at_.mode] == profile_.speed_mode &&
                     written_[at_.brake] == profile_.brake_released;
  return turns ? written_[at_.speed_set_point] : 0.0;
}

double ModbusServoModel::Torque() const {
  const bool pulls = power_ == PowerState::kOperationEnabled && written_[at_.mode] == profile_.torque_mode;
  return pulls ? written_[at_.torque_set_point] : 0.0;
}

double ModbusServoModel::Read(std::size_t index, nanoseconds now) {
  const std::lock_guard lock(mutex_);
  Supervise(now);
  if (index == at_.status) return StatusNumber();
  if (index == at_.actual_speed) return Speed();
  if (index == at_.actual_torque) return Torque();
  return written_[index];
}

bool ModbusServoModel::Write(std::size_t index, double value, nanoseconds now) {
  const std::lock_guard lock(mutex_);
  Supervise(now);
  log_.push_back(fmt::format("{} {:.6g}", map_.registers[index].name, value));
  fed_ = now;
  const bool fixed = index == at_.watchdog_time && fixed_watchdog_time_s_ >= 0;
  written_[index] = fixed ? fixed_watchdog_time_s_ : value;
  if (index != at_.control) return true;
  const bool fault = power_ == PowerState::kFault;
  if (value == profile_.control.reset_fault && fault) power_ = PowerState::kSwitchOnDisabled;
  if (fault) return true;
  if (value == profile_.control.enable) power_ = PowerState::kOperationEnabled;
  if (value == profile_.control.off) power_ = PowerState::kSwitchOnDisabled;
  if (value == profile_.control.quick_stop && power_ == PowerState::kOperationEnabled) {
    power_ = PowerState::kQuickStopActive;
  }
  return true;
}

void ModbusServoModel::Hear(nanoseconds now) {
  const std::lock_guard lock(mutex_);
  Supervise(now);
  if (watchdog_ == Watchdog::kAnything) fed_ = now;
}

void ModbusServoModel::set_watchdog(Watchdog watchdog) {
  const std::lock_guard lock(mutex_);
  watchdog_ = watchdog;
}

void ModbusServoModel::set_fixed_watchdog_time(double time_s) {
  const std::lock_guard lock(mutex_);
  fixed_watchdog_time_s_ = time_s;
}

void ModbusServoModel::Fault() {
  const std::lock_guard lock(mutex_);
  power_ = PowerState::kFault;
}

PowerState ModbusServoModel::power(nanoseconds now) {
  const std::lock_guard lock(mutex_);
  Supervise(now);
  return power_;
}

bool ModbusServoModel::brake_engaged() {
  const std::lock_guard lock(mutex_);
  return written_[at_.brake] == profile_.brake_engaged;
}

double ModbusServoModel::actual_speed_rad_per_s(nanoseconds now) {
  const std::lock_guard lock(mutex_);
  Supervise(now);
  return Speed();
}

std::vector<std::string> ModbusServoModel::TakeWritten() {
  const std::lock_guard lock(mutex_);
  return std::exchange(log_, {});
}

}  // namespace strainwave::bench
