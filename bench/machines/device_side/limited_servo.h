// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <chrono>
#include <limits>

#include "bench/roles/servo_drive.h"

namespace strainwave::bench {

/// A servo that may give less than it is asked for and go on as if nothing were: a limit set wrongly, a
/// coupling that slips. Once a step of the servo it is told its set points.
class LimitedServo final : public ServoDrive {
 public:
  /// @param servo  outlives this.
  explicit LimitedServo(ServoDrive& servo) : servo_(servo) {}

  /// Nm and rad/s at the servo's shaft; infinity: as much as the servo has.
  void LimitTorque(double most_Nm) noexcept { most_Nm_ = most_Nm; }
  void LimitSpeed(double most_rad_per_s) noexcept {
    most_rad_per_s_ = most_rad_per_s;
    position_rad_ = servo_.Actual().position_rad;
    position_time_ = servo_.Actual().time;
  }

  void Enable(DriveMode mode) noexcept override {
    position_rad_ = servo_.Actual().position_rad;
    position_time_ = servo_.Actual().time;
    set_point_ = mode == DriveMode::kPosition ? position_rad_ : 0.0;
    servo_.Enable(mode);
  }
  void Disable() noexcept override { servo_.Disable(); }
  void QuickStop() noexcept override { servo_.QuickStop(); }
  void ResetFault() noexcept override { servo_.ResetFault(); }
  void SetBrake(bool engaged) noexcept override { servo_.SetBrake(engaged); }
  void CommandSpeed(double speed_rad_per_s) noexcept override {
    set_point_ = speed_rad_per_s;
    servo_.CommandSpeed(std::clamp(speed_rad_per_s, -most_rad_per_s_, most_rad_per_s_));
  }
  void CommandTorque(double torque_Nm) noexcept override {
    set_point_ = torque_Nm;
    servo_.CommandTorque(std::clamp(torque_Nm, -most_Nm_, most_Nm_));
  }
  // Moves there no faster than the limit.
  void CommandPosition(double position_rad) noexcept override {
    set_point_ = position_rad;
    const std::chrono::nanoseconds now = servo_.Actual().time;
    const double most_rad =
        most_rad_per_s_ * std::chrono::duration<double>(std::max(now - position_time_, kLeastStep)).count();
    position_rad_ += std::clamp(position_rad - position_rad_, -most_rad, most_rad);
    position_time_ = now;
    servo_.CommandPosition(position_rad_);
  }
  DriveActual Actual() const noexcept override { return servo_.Actual(); }

  /// What it was asked for last: Nm, rad/s or rad.
  double set_point() const noexcept { return set_point_; }

 private:
  static constexpr std::chrono::nanoseconds kLeastStep{1};  // none times infinity is no number

  ServoDrive& servo_;
  double most_Nm_{std::numeric_limits<double>::infinity()};
  double most_rad_per_s_{std::numeric_limits<double>::infinity()};
  double set_point_{};
  double position_rad_{};  // that was commanded last
  std::chrono::nanoseconds position_time_{};
};

}  // namespace strainwave::bench
