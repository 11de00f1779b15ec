// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>

#include "bench/roles/servo_drive.h"

namespace strainwave::bench {

/// What goes wrong with a drive of the simulated bench, put in by a test.
struct DriveFaults {
  bool silent{};       // says what it said last, and obeys
  bool dropped_out{};  // leaves operation enabled without a fault, and does not come up again
  bool brake_on{};     // its brake is on, whatever was asked for
  double share{1.0};   // that it gives of the speed or torque asked for
};

/// The drive's side of a servo on the simulated bench: walks the CiA 402 power states, one transition a step
/// of the bench, and keeps mode, set point and brake for the plant to look at.
class SimulatedDrive final : public ServoDrive {
 public:
  /// @param has_position_mode  without it, as the load servo is: asked for a position, it stays below
  ///   operation enabled.
  explicit SimulatedDrive(bool has_position_mode) : has_position_mode_(has_position_mode) {}

  void Enable(DriveMode mode) noexcept override;
  void Disable() noexcept override;
  void QuickStop() noexcept override;
  void ResetFault() noexcept override;
  void SetBrake(bool engaged) noexcept override;
  void CommandSpeed(double speed_rad_per_s) noexcept override;
  void CommandPosition(double position_rad) noexcept override;
  void CommandTorque(double torque_Nm) noexcept override;
  DriveActual Actual() const noexcept override { return faults_.silent ? told_ : actual_; }

  // The bench's side.
  void StepPowerState() noexcept {
    if (moving_) Walk();
  }
  void Fault() noexcept;
  void SetFaults(const DriveFaults& faults) noexcept;
  void PowerCut() noexcept;
  void Report(std::chrono::nanoseconds time, double position_rad, double speed_rad_per_s,
              double torque_Nm) noexcept {
    actual_.time = time;
    actual_.position_rad = position_rad;
    actual_.speed_rad_per_s = speed_rad_per_s;
    actual_.torque_Nm = torque_Nm;
  }
  bool enabled() const noexcept { return actual_.power == protocols::PowerState::kOperationEnabled; }
  DriveMode mode() const noexcept { return mode_; }
  double set_point() const noexcept { return set_point_; }
  bool brake_engaged() const noexcept { return actual_.brake_engaged; }

 private:
  void Walk() noexcept;
  void Send(std::uint16_t controlword) noexcept;
  void Set(DriveMode mode, double value) noexcept;

  bool has_position_mode_;
  bool moving_{};  // a transition is due
  bool towards_enabled_{};
  DriveMode mode_{DriveMode::kTorque};
  double set_point_{};
  std::uint16_t controlword_{};
  DriveFaults faults_;
  DriveActual actual_;
  DriveActual told_;  // the last before it fell silent
};

}  // namespace strainwave::bench
