// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>

#include "bench/roles/servo_drive.h"
#include "protocols/canopen/drive_physics.h"
#include "protocols/canopen/eds_file.h"

namespace strainwave::bench {

/// What the increments and per mille of a drive are at the shaft of a servo.
struct ServoUnits {
  double increments_per_turn{};  // of the shaft that `ServoDrive` speaks of
  double rated_torque_Nm{};      // 6076h, at the same shaft
  int sign{1};                   // -1: the drive counts against the bench's positive direction
};

/// The units that an EDS file states (608Fh, 6076h).
/// @throws std::invalid_argument when it does not, or states zero.
ServoUnits UnitsOf(const protocols::canopen::EdsFile& eds, int sign);

/// Joins the software of a CANopen drive with a servo of the bench: what a motor is to a drive.
/// Its torque limit (6072h) acts on torque set points; the speed loop of a `ServoDrive` is the servo's own.
class ServoPhysics final : public protocols::canopen::device::DrivePhysics {
 public:
  /// @param servo  must outlive this. @throws std::invalid_argument for units that are not above zero.
  ServoPhysics(ServoDrive& servo, const ServoUnits& units);

  protocols::canopen::device::DriveReading Read() noexcept override;
  void Command(const protocols::canopen::device::DriveCommand& command) noexcept override;
  void ResetFault() noexcept override;

  /// The hard-wired input, as a test works it.
  void OpenSafeTorqueOff(bool open) noexcept { safe_torque_off_ = open; }

 private:
  void Enable(protocols::canopen::device::DriveLoop loop) noexcept;

  ServoDrive& servo_;
  ServoUnits units_;
  double rad_per_inc_;
  double Nm_per_permille_;
  protocols::canopen::device::DriveLoop loop_{protocols::canopen::device::DriveLoop::kOff};
  bool safe_torque_off_{};
};

}  // namespace strainwave::bench
