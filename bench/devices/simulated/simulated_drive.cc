// SPDX-License-Identifier: Apache-2.0
#include "bench/devices/simulated/simulated_drive.h"

namespace strainwave::bench {

using protocols::PowerState;

void SimulatedDrive::Send(std::uint16_t controlword) noexcept {
  actual_.power = protocols::NextPowerState(actual_.power, controlword_, controlword);
  controlword_ = controlword;
}

void SimulatedDrive::Walk() noexcept {
  // What the drive does by itself takes none of the master's steps, so that coming up takes the same time
  // from a power cut, from a quick stop, and from standstill.
  if (actual_.power == PowerState::kNotReadyToSwitchOn || actual_.power == PowerState::kQuickStopActive) {
    actual_.power = PowerState::kSwitchOnDisabled;
  }
  switch (actual_.power) {
    case PowerState::kNotReadyToSwitchOn:
    case PowerState::kQuickStopActive:
      break;
    case PowerState::kFaultReactionActive:
      actual_.power = PowerState::kFault;
      break;
    case PowerState::kFault:
      break;
    case PowerState::kSwitchOnDisabled:
    case PowerState::kReadyToSwitchOn:
    case PowerState::kSwitchedOn: {
      if (!towards_enabled_) break;
      const auto controlword = protocols::ControlwordTowardsEnabled(actual_.power);
      if (!controlword) break;
      Send(*controlword);
      // No jump: a position starts where the shaft is, speed and torque at nothing.
      if (enabled()) set_point_ = mode_ == DriveMode::kPosition ? actual_.position_rad : 0.0;
      break;
    }
    case PowerState::kOperationEnabled:
      break;
  }
  moving_ = towards_enabled_ && !enabled() && actual_.power != PowerState::kFault;
}

void SimulatedDrive::Enable(DriveMode mode) noexcept {
  if (actual_.power == PowerState::kFault || actual_.power == PowerState::kFaultReactionActive) return;
  if (faults_.dropped_out) return;
  mode_ = mode;
  set_point_ = mode == DriveMode::kPosition ? actual_.position_rad : 0.0;
  towards_enabled_ = has_position_mode_ || mode != DriveMode::kPosition;
  if (!towards_enabled_ && enabled()) Disable();
  moving_ = true;
}

void SimulatedDrive::Disable() noexcept {
  towards_enabled_ = false;
  set_point_ = 0.0;
  Send(protocols::kControlwordDisableVoltage);
  moving_ = true;
}

void SimulatedDrive::QuickStop() noexcept {
  towards_enabled_ = false;
  set_point_ = 0.0;
  Send(protocols::kControlwordQuickStop);
  actual_.brake_engaged = true;
  moving_ = true;
}

void SimulatedDrive::ResetFault() noexcept {
  Send(0);
  Send(protocols::kControlwordFaultReset);
  moving_ = true;
}

void SimulatedDrive::SetBrake(bool engaged) noexcept {
  actual_.brake_engaged = engaged || faults_.brake_on || faults_.dropped_out;
}

void SimulatedDrive::SetFaults(const DriveFaults& faults) noexcept {
  if (!faults_.silent) told_ = actual_;
  faults_ = faults;
  if (faults.dropped_out && enabled()) {
    towards_enabled_ = false;
    set_point_ = 0.0;
    actual_.power = PowerState::kSwitchOnDisabled;
  }
  if (faults.dropped_out || faults.brake_on) actual_.brake_engaged = true;
}

void SimulatedDrive::Fault() noexcept {
  if (actual_.power == PowerState::kFault) return;
  towards_enabled_ = false;
  set_point_ = 0.0;
  actual_.power = PowerState::kFaultReactionActive;
  moving_ = true;
}

void SimulatedDrive::PowerCut() noexcept {
  towards_enabled_ = false;
  set_point_ = 0.0;
  controlword_ = 0;
  actual_.power = PowerState::kNotReadyToSwitchOn;
  actual_.brake_engaged = true;
  moving_ = true;
}

void SimulatedDrive::Set(DriveMode mode, double value) noexcept {
  if (enabled() && mode_ == mode) set_point_ = value;
}

void SimulatedDrive::CommandSpeed(double speed_rad_per_s) noexcept {
  Set(DriveMode::kSpeed, faults_.share * speed_rad_per_s);
}
void SimulatedDrive::CommandPosition(double position_rad) noexcept {
  Set(DriveMode::kPosition, position_rad);
}
void SimulatedDrive::CommandTorque(double torque_Nm) noexcept {
  Set(DriveMode::kTorque, faults_.share * torque_Nm);
}

}  // namespace strainwave::bench
