// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>

namespace strainwave::analysis::model {

/// Where a joint stands, and how it moves.
struct JointState {
  double angle_rad{};
  double speed_rad_per_s{};
  double acceleration_rad_per_s2{};
};

/// A joint that goes to and fro between 0 and its stroke: speed as a trapezoid, a rest at each end.
struct ToAndFro {
  double stroke_rad{};
  double top_speed_rad_per_s{};
  double acceleration_rad_per_s2{};
  double rest_s{};

  /// Of one stroke, without the rest.
  double StrokeTime_s() const {
    const double top = Top();
    return stroke_rad / top + top / acceleration_rad_per_s2;
  }
  /// There and back, with both rests.
  double Period_s() const { return 2.0 * (StrokeTime_s() + rest_s); }

  JointState At(double time_s) const {
    const double half_s = 0.5 * Period_s();
    const double in_period_s = time_s - Period_s() * std::floor(time_s / Period_s());
    const bool back = in_period_s >= half_s;
    const JointState there = Along(std::min(back ? in_period_s - half_s : in_period_s, StrokeTime_s()));
    if (!back) return there;
    return {stroke_rad - there.angle_rad, -there.speed_rad_per_s, -there.acceleration_rad_per_s2};
  }

 private:
  // A short stroke turns round before it has its full speed.
  double Top() const {
    return std::min(top_speed_rad_per_s, std::sqrt(stroke_rad * acceleration_rad_per_s2));
  }

  JointState Along(double time_s) const {
    const double top = Top();
    const double ramp_s = top / acceleration_rad_per_s2;
    const double left_s = StrokeTime_s() - time_s;
    if (time_s < ramp_s)
      return {0.5 * acceleration_rad_per_s2 * time_s * time_s, acceleration_rad_per_s2 * time_s,
              acceleration_rad_per_s2};
    if (left_s <= 0.0) return {stroke_rad, 0.0, 0.0};
    if (left_s < ramp_s)
      return {stroke_rad - 0.5 * acceleration_rad_per_s2 * left_s * left_s, acceleration_rad_per_s2 * left_s,
              -acceleration_rad_per_s2};
    return {0.5 * top * ramp_s + top * (time_s - ramp_s), top, 0.0};
  }
};

}  // namespace strainwave::analysis::model
