// SPDX-License-Identifier: Apache-2.0
#include "bench/controller/motion.h"

#include <algorithm>
#include <cmath>

namespace strainwave::bench {

double Ramp::Step(double target, double period_s) noexcept {
  const double most = rate_per_s_ * period_s;
  value_ += std::clamp(target - value_, -most, most);
  return value_;
}

PointToPoint::PointToPoint(double from_rad, double to_rad, double speed_rad_per_s,
                           double acceleration_rad_per_s2)
    : from_rad_(from_rad), distance_rad_(to_rad - from_rad) {
  const double distance = std::abs(distance_rad_);
  const double peak_speed = std::min(speed_rad_per_s, std::sqrt(distance * acceleration_rad_per_s2));
  acceleration_s_ = peak_speed / acceleration_rad_per_s2;
  cruise_s_ = peak_speed > 0.0 ? distance / peak_speed - acceleration_s_ : 0.0;
}

double PointToPoint::PositionAt(double elapsed_s) const noexcept {
  const double total_s = duration_s();
  if (elapsed_s >= total_s) return from_rad_ + distance_rad_;
  if (elapsed_s <= 0.0) return from_rad_;
  // Shares of the distance, so that the sign needs no care: the peak speed is 1 / (ta + tc).
  const double peak = 1.0 / (acceleration_s_ + cruise_s_);
  double share = 0.0;
  if (elapsed_s < acceleration_s_) {
    share = 0.5 * peak * elapsed_s * elapsed_s / acceleration_s_;
  } else if (elapsed_s < acceleration_s_ + cruise_s_) {
    share = peak * (elapsed_s - 0.5 * acceleration_s_);
  } else {
    const double left_s = total_s - elapsed_s;
    share = 1.0 - 0.5 * peak * left_s * left_s / acceleration_s_;
  }
  return from_rad_ + distance_rad_ * share;
}

double ApproachSpeed(double remaining_rad, double speed_rad_per_s, double acceleration_rad_per_s2) noexcept {
  const double braking = std::sqrt(2.0 * acceleration_rad_per_s2 * std::abs(remaining_rad));
  return std::copysign(std::min(speed_rad_per_s, braking), remaining_rad);
}

}  // namespace strainwave::bench
