// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <optional>

#include "bench/roles/servo_drive.h"
#include "bench/safety/stop_reason.h"

namespace strainwave::bench {

/// A servo drive as a phase commands it, held to what it was asked for. From the moment that it has reached
/// operation enabled until the phase lets it go, it is in operation enabled in every answer, its brake is off
/// once it was released, and no answer is older than readings may become. Enabled and silent is not enabled:
/// the same rule for drives of every kind, however they report a fault, or do not.
class DriveWatch final : public ServoDrive {
 public:
  /// To operation enabled with the brake off: a brake's relay and a drive's own checks take up to a second.
  static constexpr std::chrono::seconds kLongestWayUp{3};

  DriveWatch(ServoDrive& drive, BenchServo servo) noexcept : drive_(drive), servo_(servo) {}

  void Enable(DriveMode mode) noexcept override;
  void Disable() noexcept override;
  void QuickStop() noexcept override;
  void ResetFault() noexcept override { drive_.ResetFault(); }
  void SetBrake(bool engaged) noexcept override;
  void CommandSpeed(double speed_rad_per_s) noexcept override { drive_.CommandSpeed(speed_rad_per_s); }
  void CommandPosition(double position_rad) noexcept override { drive_.CommandPosition(position_rad); }
  void CommandTorque(double torque_Nm) noexcept override { drive_.CommandTorque(torque_Nm); }
  DriveActual Actual() const noexcept override { return drive_.Actual(); }

  /// A phase begins: what the drive said before `now` does not age it.
  void Restart(std::chrono::nanoseconds now) noexcept;

  /// Once a control period, with the drive's newest answer. None, or: it has said nothing for longer than
  /// `longest_silence` (asked for or not: a drive that is silent is not known to be off), it takes too long
  /// to come up, it has dropped out of operation enabled, its brake is on though it was released.
  StopReason Check(const DriveActual& actual, std::chrono::nanoseconds now,
                   std::chrono::nanoseconds longest_silence) noexcept;

 private:
  enum class Asked { kNothing, kToComeUp, kToStayUp };

  ServoDrive& drive_;
  BenchServo servo_;
  Asked asked_{Asked::kNothing};
  bool brake_released_{};                                  // asked for
  std::optional<std::chrono::nanoseconds> brake_seen_on_;  // at the time of this answer, though released
  std::optional<std::chrono::nanoseconds> way_up_begin_;   // with the first check after the order
  std::chrono::nanoseconds restarted_{};
};

}  // namespace strainwave::bench
