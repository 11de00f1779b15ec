// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>

#include "protocols/canopen/drive_image.h"
#include "protocols/canopen/drive_profile.h"
#include "protocols/cia402_modes.h"

namespace strainwave::protocols::canopen {

/// Set-points of an enabled drive: kept within the profile's limits, and in the cyclic modes led up to what
/// is asked for, so that none of them jumps.
class SetPoints {
 public:
  explicit SetPoints(const DriveProfile& profile);

  /// Forgets what was asked for; the targets become the actual position, no speed and no torque.
  void Hold(const DriveInputs& inputs, DriveOutputs& outputs) noexcept;

  /// False, and nothing changes, for a value that is not finite or that the drive cannot count. A position is
  /// sent with the lower 32 bits of its counts, as drives count on through their ends; one that is half the
  /// numbers or more away from where the drive stands would be reached the other way round.
  bool AskSpeed(double speed_rad_per_s) noexcept;
  bool AskPosition(double position_rad, const DriveInputs& inputs) noexcept;
  bool AskTorque(double torque_Nm) noexcept;
  void AskHoming() noexcept;

  /// Sets the targets of this mode, `elapsed` after the last call, and the mode's bits of the controlword.
  void Step(OperationMode mode, std::uint16_t statusword, std::chrono::nanoseconds elapsed,
            DriveOutputs& outputs) noexcept;

 private:
  enum class Handshake : std::uint8_t { kIdle, kPlaced, kRaised, kLowered };

  void StepProfilePosition(const StatusBits& bits, DriveOutputs& outputs) noexcept;
  void StepCyclicPosition(double elapsed_s, DriveOutputs& outputs) noexcept;
  void StepCyclicSpeed(double elapsed_s, DriveOutputs& outputs) noexcept;

  DriveUnits units_;
  DriveLimits limits_;

  double speed_rad_per_s_{};
  double torque_Nm_{};
  std::optional<std::int64_t> position_counts_;  // asked for
  bool homing_asked_{};
  bool homing_runs_{};  // the drive was seen not attained since

  double led_speed_rad_per_s_{};
  double led_position_counts_{};
  Handshake handshake_{Handshake::kIdle};
};

}  // namespace strainwave::protocols::canopen
