// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>

namespace strainwave::analysis::model {

/// Share of the breakaway surplus that is left at a speed: exp(−(ω/ω_s)²), 1 at rest (E8).
inline double StribeckShare(double speed, double stribeck_speed) noexcept {
  const double relative = speed / stribeck_speed;
  return std::abs(relative) < 6.0 ? std::exp(-relative * relative) : 0.0;
}

/// The far side of a joint with play, moved by contact alone: it stays until the near side has crossed the
/// gap of this width, then follows at half a gap's distance.
class Play {
 public:
  Play(double width, double near, double first_direction) noexcept
      : half_(0.5 * width), far_(near - (first_direction < 0.0 ? -half_ : half_)) {}

  /// @returns position of the far side.
  double Follow(double near) noexcept {
    far_ = std::clamp(far_, near - half_, near + half_);
    return far_;
  }

 private:
  double half_;
  double far_;
};

/// A second inertia behind a spring and a damper, driven by the motion of the near side: the twist x = far −
/// near follows ẍ + 2ζω₀ẋ + ω₀²x = −a, where a is the acceleration of the near side and ω₀ the frequency at
/// which the far side swings with the near side held. Exact for an acceleration that is linear within a step
/// (E15).
class SecondInertia {
 public:
  SecondInertia(double natural_rad_per_s, double damping_ratio, double step_s) noexcept
      : natural_(natural_rad_per_s), damping_(damping_ratio), step_(step_s) {
    const double decay = std::exp(-damping_ * natural_ * step_);
    const double root = std::sqrt(std::max(1e-12, 1.0 - damping_ * damping_));
    const double damped = natural_ * root;
    const double c = decay * std::cos(damped * step_);
    const double s = decay * std::sin(damped * step_);
    position_by_position_ = c + damping_ / root * s;
    position_by_speed_ = s / damped;
    speed_by_position_ = -natural_ / root * s;
    speed_by_speed_ = c - damping_ / root * s;
  }

  /// Moves on by a step, over which the acceleration changes to `acceleration`.
  /// @returns acceleration of the far side less that of the near side.
  double Step(double acceleration) noexcept {
    const double slope = started_ ? (acceleration - last_) / step_ : 0.0;
    const double before = started_ ? last_ : acceleration;
    // Particular solution of a constant and a ramp: −a/ω₀² + 2ζ·slope/ω₀³ − slope·t/ω₀².
    const double square = natural_ * natural_;
    const double constant = -before / square + 2.0 * damping_ * slope / (square * natural_);
    const double rate = -slope / square;
    if (!started_) {
      twist_ = constant;  // as if it had gone on like this before
      speed_ = rate;
      started_ = true;
    } else {
      const double x = twist_ - constant;
      const double v = speed_ - rate;
      twist_ = position_by_position_ * x + position_by_speed_ * v + constant + rate * step_;
      speed_ = speed_by_position_ * x + speed_by_speed_ * v + rate;
    }
    last_ = acceleration;
    return -acceleration - 2.0 * damping_ * natural_ * speed_ - square * twist_;
  }

 private:
  double natural_, damping_, step_;
  double position_by_position_{}, position_by_speed_{}, speed_by_position_{}, speed_by_speed_{};
  double twist_{}, speed_{}, last_{};
  bool started_{};
};

}  // namespace strainwave::analysis::model
