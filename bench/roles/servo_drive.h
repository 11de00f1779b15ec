// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>

#include "protocols/cia402.h"

namespace strainwave::bench {

/// What a drive closes its own loop on.
enum class DriveMode { kSpeed, kPosition, kTorque };

/// What a drive says of itself, with the time at which it was true: a stale value is not a value.
struct DriveActual {
  std::chrono::nanoseconds time{};
  double position_rad{};
  bool tells_position{true};  // else it is zero, and means nothing
  double speed_rad_per_s{};
  double torque_Nm{};
  protocols::PowerState power{protocols::PowerState::kSwitchOnDisabled};
  bool brake_engaged{true};
};

/// One servo drive with its holding brake, in rad, rad/s and N·m at the shaft it drives. Positive is
/// clockwise seen from the output side of the bench (bench/README.md).
///
/// Every call is made from the control thread and returns at once: a call is a request, `Actual()` tells
/// what became of it. None of them throws or allocates.
class ServoDrive {
 public:
  ServoDrive() = default;
  ServoDrive(const ServoDrive&) = delete;
  ServoDrive& operator=(const ServoDrive&) = delete;
  virtual ~ServoDrive() = default;

  /// Walks the power states up to operation enabled in this mode. The set point starts at the actual value
  /// (speed and torque: at zero), whatever was commanded before.
  virtual void Enable(DriveMode mode) noexcept = 0;
  /// Torque off. The brake is not touched.
  virtual void Disable() noexcept = 0;
  /// Torque off and brake on, at once; every queued set point is dropped.
  virtual void QuickStop() noexcept = 0;
  virtual void ResetFault() noexcept = 0;
  virtual void SetBrake(bool engaged) noexcept = 0;

  /// The set point of the mode in force; ignored unless operation is enabled in that mode.
  virtual void CommandSpeed(double speed_rad_per_s) noexcept = 0;
  virtual void CommandPosition(double position_rad) noexcept = 0;
  virtual void CommandTorque(double torque_Nm) noexcept = 0;

  virtual DriveActual Actual() const noexcept = 0;
};

}  // namespace strainwave::bench
