// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

#include "protocols/canopen/drive_objects.h"
#include "protocols/canopen/drive_physics.h"
#include "protocols/canopen/power_stage.h"

namespace strainwave::protocols::canopen::device {

/// The modes of operation of CiA 402-2: from targets and ramps to set points, and the bits of the statusword
/// that tell of them. Homing knows methods 35 and 37 (the place where the shaft stands is home).
///
/// A stop ramps the speed down and keeps the speed loop; a drive that has no mode with a speed loop ramps its
/// torque to zero instead. In the torque modes a motor that is faster than 6080h is not driven further.
///
/// Between two targets of a cyclic mode the set point goes in a straight line over the interpolation time
/// 60C2h, so that a master with a long period drives as smoothly as one with a short period, one period
/// later.
class DriveMotion {
 public:
  explicit DriveMotion(DriveObjects& objects) : objects_(objects) {}

  /// One cycle of `dt_s`; loop off unless the state has power. Writes the demand values to the dictionary.
  DriveCommand Step(double dt_s, PowerState state, DriveMode mode, const StopOptions& options,
                    const DriveReading& reading);

  /// Writes what was measured to the dictionary.
  void Report(const DriveReading& reading);

  /// From now on the place where the motor is has this position; what it is doing does not change.
  void CountFrom(double position);

  /// The ramp of a stop has come to its end, or there is nothing to stop.
  bool stopped() const { return stopped_; }
  /// 6065h was exceeded for 6066h.
  bool following_error() const { return following_error_; }
  /// Bits 10 to 13 of the statusword.
  std::uint16_t status_bits() const { return status_bits_; }

 private:
  enum class Ramp : std::uint8_t { kSlowDown, kQuickStop };

  void Begin(const DriveReading& reading);
  DriveCommand Stop(double dt_s, Ramp ramp, const DriveReading& reading);
  DriveCommand Run(double dt_s, DriveMode mode);
  DriveCommand ProfilePosition(double dt_s);
  DriveCommand ProfileVelocity(double dt_s);
  DriveCommand Torque(double dt_s, bool cyclic);
  DriveCommand Home();
  DriveCommand CyclicPosition(double dt_s);
  DriveCommand CyclicVelocity(double dt_s);
  double Interpolated(double from, double target, double dt_s);
  DriveCommand HoldPosition() const;
  DriveCommand HoldSpeed() const;

  void TakeSetPoints();
  void SupervisePosition(double dt_s, bool final);
  bool HeldFor(double& held_s, double dt_s, bool condition, const Object& time_ms);
  double Clamp(double value, double most);
  double Units(double inc) const;
  bool ControlBit(int bit) const;
  void SetStatus(int bit, bool set);

  DriveObjects& objects_;
  // Units: of position as 6092h has it, but not wrapped; per second; per mille.
  double actual_position_{};
  double actual_speed_{};
  double position_{};
  double speed_{};
  double torque_{};
  double home_{};  // the motor's place that is position zero, in units
  std::optional<double> cyclic_target_;
  double to_cyclic_target_s_{};
  DriveMode mode_{DriveMode::kNone};
  bool running_{};
  bool stopping_{};
  double stopping_s_{};
  bool stopped_{true};
  bool following_error_{};
  std::uint16_t status_bits_{};

  bool start_bit_{};  // bit 4 of the controlword as it was
  double target_{};
  bool has_next_{};
  double next_target_{};
  bool homed_{};
  double in_window_s_{};
  double outside_s_{};
};

}  // namespace strainwave::protocols::canopen::device
