// SPDX-License-Identifier: Apache-2.0
#include "bench/machines/device_side/servo_physics.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

#include "analysis/units.h"

namespace strainwave::bench {

using protocols::PowerState;
using protocols::canopen::EdsFile;
using protocols::canopen::EdsNumber;
using protocols::canopen::ObjectAddress;
using protocols::canopen::device::DriveCommand;
using protocols::canopen::device::DriveLoop;
using protocols::canopen::device::DriveReading;

namespace {

double Stated(const EdsFile& eds, ObjectAddress address) {
  const auto found = eds.objects.find(address);
  const std::optional<std::int64_t> number =
      found == eds.objects.end() ? std::nullopt : EdsNumber(found->second.default_value, 1);
  if (!number || *number <= 0) {
    throw std::invalid_argument(
        fmt::format("the EDS file gives no default of object {:04X}:{:02X} (must be above zero)",
                    address.index, address.subindex));
  }
  return static_cast<double>(*number);
}

}  // namespace

ServoUnits UnitsOf(const EdsFile& eds, int sign) {
  ServoUnits units;
  units.increments_per_turn = Stated(eds, {0x608F, 1}) / Stated(eds, {0x608F, 2});
  units.rated_torque_Nm = Stated(eds, {0x6076, 0}) / 1000.0;
  units.sign = sign;
  return units;
}

ServoPhysics::ServoPhysics(ServoDrive& servo, const ServoUnits& units) : servo_(servo), units_(units) {
  const auto demand = [](const char* name, double value) {
    if (value > 0.0 && std::isfinite(value)) return;
    throw std::invalid_argument(fmt::format("{} = {} (must be finite and above zero)", name, value));
  };
  demand("increments_per_turn", units.increments_per_turn);
  demand("rated_torque_Nm", units.rated_torque_Nm);
  if (units.sign != 1 && units.sign != -1) {
    throw std::invalid_argument(fmt::format("sign = {} (must be 1 or -1)", units.sign));
  }
  rad_per_inc_ = units.sign * kTwoPi / units.increments_per_turn;
  Nm_per_permille_ = units.sign * units.rated_torque_Nm / 1000.0;
}

DriveReading ServoPhysics::Read() noexcept {
  const DriveActual actual = servo_.Actual();
  DriveReading reading;
  reading.position_inc = actual.position_rad / rad_per_inc_;
  reading.speed_inc_per_s = actual.speed_rad_per_s / rad_per_inc_;
  reading.torque_permille = actual.torque_Nm / Nm_per_permille_;
  reading.out_of_order =
      actual.power == PowerState::kFault || actual.power == PowerState::kFaultReactionActive;
  reading.safe_torque_off = safe_torque_off_;
  return reading;
}

void ServoPhysics::Enable(DriveLoop loop) noexcept {
  switch (loop) {
    case DriveLoop::kSpeed:
      return servo_.Enable(DriveMode::kSpeed);
    case DriveLoop::kPosition:
      return servo_.Enable(DriveMode::kPosition);
    case DriveLoop::kTorque:
      return servo_.Enable(DriveMode::kTorque);
    case DriveLoop::kOff:
      return servo_.Disable();
  }
}

void ServoPhysics::Command(const DriveCommand& command) noexcept {
  // Power off first: the stop must not wait for anything.
  if (command.loop != loop_) Enable(command.loop);
  loop_ = command.loop;
  if (command.brake_engaged != servo_.Actual().brake_engaged) servo_.SetBrake(command.brake_engaged);
  switch (command.loop) {
    case DriveLoop::kSpeed:
      return servo_.CommandSpeed(command.speed_inc_per_s * rad_per_inc_);
    case DriveLoop::kPosition:
      return servo_.CommandPosition(command.position_inc * rad_per_inc_);
    case DriveLoop::kTorque: {
      const double most = command.torque_limit_permille;
      return servo_.CommandTorque(std::clamp(command.torque_permille, -most, most) * Nm_per_permille_);
    }
    case DriveLoop::kOff:
      return;
  }
}

void ServoPhysics::ResetFault() noexcept {
  servo_.ResetFault();
  loop_ = DriveLoop::kOff;
}

}  // namespace strainwave::bench
