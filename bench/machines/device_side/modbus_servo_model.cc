// SPDX-License-Identifier: Apache-2.0
#include "bench/machines/device_side/modbus_servo_model.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace strainwave::bench {

using protocols::PowerState;
using protocols::modbus::ValueType;
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
  if (quiet.count() > time_s) EnterFault();
}

// Whatever is written, until it is reset.
void ModbusServoModel::EnterFault() {
  power_ = PowerState::kFault;
  written_[at_.brake] = profile_.brake_engaged;
}

double ModbusServoModel::StatusNumber() const {
  if (faults_.stuck_status) return *faults_.stuck_status;
  // A motor takes some steps to be enabled.
  const bool on_its_way =
      power_ == PowerState::kOperationEnabled && motor_ && motor_->power != PowerState::kOperationEnabled;
  const PowerState told = on_its_way ? PowerState::kSwitchedOn : power_;
  const auto row = std::ranges::find(profile_.status, told, &ModbusServoProfile::Status::state);
  return row == profile_.status.end() ? 0.0 : row->value;
}

ModbusServoModel::Actual ModbusServoModel::ActualNow() const {
  if (faults_.actual_stuck) return stuck_actual_;
  if (motor_) return {motor_->speed_rad_per_s, motor_->torque_Nm, motor_->position_rad};
  const bool enabled = power_ == PowerState::kOperationEnabled;
  const double mode = written_[at_.mode];
  const bool released = written_[at_.brake] == profile_.brake_released;
  return {enabled && released && mode == profile_.speed_mode ? written_[at_.speed_set_point] : 0.0,
          enabled && mode == profile_.torque_mode ? written_[at_.torque_set_point] : 0.0, 0.0};
}

// An integer goes over at its ends.
double ModbusServoModel::PositionRegister(double position_rad) const {
  const protocols::modbus::Register& value = map_.registers[*at_.actual_position];
  const bool is_int16 = value.type == ValueType::kInt16;
  if (!is_int16 && value.type != ValueType::kInt32) return position_rad;
  const double step_rad = std::abs(value.scale);
  const double whole_rad = step_rad * (is_int16 ? 65536.0 : 4294967296.0);
  const double most_rad = 0.5 * whole_rad - step_rad;
  return std::clamp(std::remainder(position_rad, whole_rad), -most_rad, most_rad);
}

double ModbusServoModel::Read(std::size_t index, nanoseconds now) {
  const std::lock_guard lock(mutex_);
  Supervise(now);
  if (index == at_.status) return StatusNumber();
  if (index == at_.actual_speed) return ActualNow().speed_rad_per_s;
  if (index == at_.actual_torque) return ActualNow().torque_Nm;
  if (index == at_.actual_position) return PositionRegister(ActualNow().position_rad);
  if (index == at_.brake && faults_.brake_inverted) {
    return written_[at_.brake] == profile_.brake_engaged ? profile_.brake_released : profile_.brake_engaged;
  }
  if (index == at_.watchdog && faults_.count_stuck) return stuck_count_;
  return written_[index];
}

bool ModbusServoModel::Write(std::size_t index, double value, nanoseconds now) {
  const std::lock_guard lock(mutex_);
  Supervise(now);
  log_.push_back(fmt::format("{} {:.6g}", map_.registers[index].name, value));
  fed_ = now;
  if (index == at_.brake && power_ == PowerState::kFault) return true;
  const bool fixed = index == at_.watchdog_time && fixed_watchdog_time_s_ >= 0;
  written_[index] = fixed ? fixed_watchdog_time_s_ : value;
  if (index != at_.control) return true;
  const bool fault = power_ == PowerState::kFault;
  if (value == profile_.control.reset_fault && fault) power_ = PowerState::kSwitchOnDisabled;
  if (fault) return true;
  if (value == profile_.control.enable && !faults_.enable_input_open) power_ = PowerState::kOperationEnabled;
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

void ModbusServoModel::Turn(ServoDrive& motor, double reducer_ratio, nanoseconds now) {
  const std::lock_guard lock(mutex_);
  Supervise(now);
  // Power off first: a stop must not wait for anything.
  std::optional<DriveMode> wanted;
  if (power_ == PowerState::kOperationEnabled) {
    wanted = written_[at_.mode] == profile_.speed_mode ? DriveMode::kSpeed : DriveMode::kTorque;
  }
  if (wanted != turns_in_) {
    if (wanted) {
      motor.Enable(*wanted);
    } else {
      motor.Disable();
    }
    turns_in_ = wanted;
  }
  const bool engaged = written_[at_.brake] == profile_.brake_engaged;
  if (motor.Actual().brake_engaged != engaged) motor.SetBrake(engaged);
  if (wanted == DriveMode::kSpeed) motor.CommandSpeed(written_[at_.speed_set_point] / reducer_ratio);
  if (wanted == DriveMode::kTorque) motor.CommandTorque(written_[at_.torque_set_point] * reducer_ratio);
  motor_ = motor.Actual();
  motor_->speed_rad_per_s *= reducer_ratio;
  motor_->position_rad *= reducer_ratio;
  motor_->torque_Nm /= reducer_ratio;
}

void ModbusServoModel::set_watchdog(Watchdog watchdog) {
  const std::lock_guard lock(mutex_);
  watchdog_ = watchdog;
}

void ModbusServoModel::set_fixed_watchdog_time(double time_s) {
  const std::lock_guard lock(mutex_);
  fixed_watchdog_time_s_ = time_s;
}

void ModbusServoModel::set_faults(const Faults& faults) {
  const std::lock_guard lock(mutex_);
  if (!faults_.actual_stuck) stuck_actual_ = ActualNow();
  if (!faults_.count_stuck && at_.watchdog) stuck_count_ = written_[*at_.watchdog];
  faults_ = faults;
  // The brake is the master's to set.
  if (faults.enable_input_open && power_ == PowerState::kOperationEnabled) {
    power_ = PowerState::kSwitchOnDisabled;
  }
}

ModbusServoModel::Faults ModbusServoModel::faults() {
  const std::lock_guard lock(mutex_);
  return faults_;
}

void ModbusServoModel::Fault() {
  const std::lock_guard lock(mutex_);
  EnterFault();
}

void ModbusServoModel::Restart() {
  const std::lock_guard lock(mutex_);
  std::ranges::fill(written_, 0.0);
  written_[at_.brake] = profile_.brake_engaged;
  power_ = PowerState::kSwitchOnDisabled;
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
  return ActualNow().speed_rad_per_s;
}

std::vector<std::string> ModbusServoModel::TakeWritten() {
  const std::lock_guard lock(mutex_);
  return std::exchange(log_, {});
}

}  // namespace strainwave::bench
