// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace strainwave::protocols::canopen::device {

enum class DriveLoop : std::uint8_t { kOff, kSpeed, kPosition, kTorque };

/// What the drive's software asks of its power electronics, in increments of the motor's encoder and in per
/// mille of the rated torque. Only the set point of the loop counts.
struct DriveCommand {
  DriveLoop loop{DriveLoop::kOff};
  double position_inc{};
  double speed_inc_per_s{};
  double torque_permille{};
  double torque_limit_permille{};
  bool brake_engaged{true};

  bool operator==(const DriveCommand&) const = default;
};

/// What it measures.
struct DriveReading {
  double position_inc{};  // counted on over any number of turns
  double speed_inc_per_s{};
  double torque_permille{};
  bool out_of_order{};
  bool safe_torque_off{};  // the input is open: no torque, whatever is asked for
};

/// The motor, its encoder and its brake, as a drive's software sees them.
class DrivePhysics {
 public:
  DrivePhysics() = default;
  DrivePhysics(const DrivePhysics&) = delete;
  DrivePhysics& operator=(const DrivePhysics&) = delete;
  virtual ~DrivePhysics() = default;

  virtual DriveReading Read() noexcept = 0;
  virtual void Command(const DriveCommand& command) noexcept = 0;
  /// The master resets a fault: what is out of order tries again, and the next reading tells.
  virtual void ResetFault() noexcept = 0;
};

}  // namespace strainwave::protocols::canopen::device
