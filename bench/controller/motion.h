// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace strainwave::bench {

/// A set point that moves towards its target at no more than a rate.
class Ramp {
 public:
  explicit Ramp(double rate_per_s, double start = 0.0) : rate_per_s_(rate_per_s), value_(start) {}

  /// The set point after another `period_s` towards `target`.
  double Step(double target, double period_s) noexcept;
  double value() const noexcept { return value_; }

 private:
  double rate_per_s_;
  double value_;
};

/// A rest-to-rest move with bounded speed and acceleration (trapezoidal speed; triangular when short).
class PointToPoint {
 public:
  PointToPoint() = default;
  PointToPoint(double from_rad, double to_rad, double speed_rad_per_s, double acceleration_rad_per_s2);

  double PositionAt(double elapsed_s) const noexcept;
  double duration_s() const noexcept { return 2.0 * acceleration_s_ + cruise_s_; }

 private:
  double from_rad_{};
  double distance_rad_{};
  double acceleration_s_{};
  double cruise_s_{};
};

/// The speed that comes to rest `remaining_rad` ahead: at most `speed`, and never more than can still be
/// braked away with `acceleration`. Signed like `remaining_rad`.
double ApproachSpeed(double remaining_rad, double speed_rad_per_s, double acceleration_rad_per_s2) noexcept;

}  // namespace strainwave::bench
