// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>

namespace strainwave::analysis::model {

/// Share of the breakaway surplus that is left at a speed: exp(−|ω/ω_s|^δ), 1 at rest (E8). δ = 2 is usual;
/// 0.5 to 2 has been measured (Armstrong-Hélouvry, Dupont & Canudas de Wit, Automatica 30 (1994) 1083).
inline double StribeckShare(double speed, double stribeck_speed, double exponent = 2.0) noexcept {
  const double relative = std::abs(speed) / stribeck_speed;
  const double power = exponent == 2.0 ? relative * relative : std::pow(relative, exponent);
  return power < 36.0 ? std::exp(-power) : 0.0;
}

/// A load behind a gap, driven by the motion of the near side through contact alone: a stiff, damped contact
/// at either end of the gap, which pushes and never pulls, and dry friction of the load's own. All per unit
/// of the load's inertia. Where the load brakes itself it crosses the gap after the motion reverses; where it
/// coasts, as soon as the near side slows down (E4).
class InertiaBehindBacklash {
 public:
  struct Numbers {
    double gap{};
    double friction{};           // as an acceleration
    double contact_rad_per_s{};  // of the load on the contact
    double contact_damping{0.5};
    double start{
        1.0};  // position in the gap at first: 1 where the motion pushes the load, −1 at the other end
  };
  InertiaBehindBacklash(const Numbers& numbers, double near, double near_speed) noexcept
      : half_(0.5 * numbers.gap),
        friction_(numbers.friction),
        contact_rad_per_s_(numbers.contact_rad_per_s),
        stiffness_(numbers.contact_rad_per_s * numbers.contact_rad_per_s),
        drag_(2.0 * numbers.contact_damping * numbers.contact_rad_per_s),
        near_(near),
        near_speed_(near_speed),
        position_(near - numbers.start * std::copysign(half_, near_speed)),
        speed_(near_speed) {}

  /// Moves on by a step, over which the near side goes to `near` smoothly.
  /// @returns push of the contact on the load at its end.
  double Follow(double near, double near_speed, double step_s) noexcept {
    const int steps = std::max(1, static_cast<int>(std::ceil(step_s * contact_rad_per_s_ / kFine)));
    const double share = 1.0 / steps;
    const double h = step_s * share;
    // Cubic between the ends, by position and speed: near + u (first + u (second + u third)).
    const double way = near - near_;
    const double first = step_s * near_speed_;
    const double second = 3.0 * way - step_s * (2.0 * near_speed_ + near_speed);
    const double third = step_s * (near_speed_ + near_speed) - 2.0 * way;
    // All in ways over one short step: what waits for the step before is then a product, two sums and a
    // choice.
    const double stiffness = h * h * stiffness_;
    const double drag = h * drag_;
    const double friction = h * h * friction_;
    const double kept = 1.0 - stiffness - drag;  // of the load's way, by a contact
    const double edge = stiffness * half_;
    double load_way = h * speed_;
    double moved = 0.0;  // of the push
    for (int k = 1; k <= steps; ++k) {
      const double u = static_cast<double>(k) * share;
      const double at = near_ + u * (first + u * (second + u * third));
      const double at_way = share * (first + u * (2.0 * second + 3.0 * u * third));
      // Positions at a step's ends, ways between them (leapfrog): else the contact gives the load back some
      // of what its damping takes.
      const double led = stiffness * (at - position_) + drag * at_way;
      position_ += load_way;
      const double lead = at - position_;
      double free = load_way;
      if (lead > half_)
        free = std::max(led - edge + kept * load_way, load_way);
      else if (lead < -half_)
        free = std::min(led + edge + kept * load_way, load_way);
      moved = free - load_way;
      // Friction stops, it does not turn round.
      load_way = free > friction ? free - friction : free < -friction ? free + friction : 0.0;
    }
    speed_ = load_way / h;
    near_ = near;
    near_speed_ = near_speed;
    return moved / (h * h);
  }

 private:
  static constexpr double kFine = 0.5;  // of a step, in radians of the contact's own swing

  double half_, friction_, contact_rad_per_s_, stiffness_, drag_;
  double near_, near_speed_;
  double position_, speed_;
};

/// A second inertia behind a spring and a damper, driven by the motion of the near side: the twist x = far −
/// near follows ẍ + 2ζω₀ẋ + ω₀²x = −a, where a is the acceleration of the near side and ω₀ the frequency at
/// which the far side swings with the near side held. Exact for an acceleration that is linear within a step
/// (docs/effects.md E15).
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

  /// Moves on by a step, over which the acceleration changes to `acceleration`; the first call only starts.
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
