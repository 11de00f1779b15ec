// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

#include "bench/machines/device_side/limited_servo.h"

namespace strainwave::bench {

/// How long the shafts really turned under a load that somebody asked for: both servos in operation enabled
/// with their brakes off, the load servo asked for a torque, and both giving what they are asked for, within
/// a fifth of it, or since half a second at most asked for something else. What is credited as load is held
/// against it.
class ServedLoad {
 public:
  /// Once a step of the servos.
  void Step(const LimitedServo& driving, const LimitedServo& load, double step_s) noexcept {
    const bool turns = speed_.Step(driving.set_point(), driving.Actual().speed_rad_per_s, step_s);
    const bool pulls = torque_.Step(load.set_point(), load.Actual().torque_Nm, step_s);
    const bool is_asked = load.set_point() != 0.0 || torque_.stands_s < kSettles_s;
    if (IsUp(driving) && IsUp(load) && turns && pulls && is_asked) served_s_ += step_s;
  }
  double served_s() const noexcept { return served_s_; }

 private:
  static constexpr double kSettles_s = 0.5;
  static constexpr double kShare = 0.2;

  struct Followed {
    double asked{};
    double stands_s{kSettles_s};

    bool Step(double now_asked, double given, double step_s) noexcept {
      stands_s = now_asked == asked ? stands_s + step_s : 0.0;
      asked = now_asked;
      return stands_s < kSettles_s || std::abs(given - asked) <= kShare * std::abs(asked);
    }
  };

  static bool IsUp(const LimitedServo& servo) noexcept {
    const DriveActual actual = servo.Actual();
    return actual.power == protocols::PowerState::kOperationEnabled && !actual.brake_engaged;
  }

  Followed speed_;
  Followed torque_;
  double served_s_{};
};

}  // namespace strainwave::bench
