// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

#include "analysis/units.h"

namespace strainwave::bench {

/// A lightly damped mode as a second-order recursion on samples.
struct Resonator {
  double a1{}, a2{}, gain{};
  double y1{}, y2{};
  double strike{};  // for which an impulse of one rings as e^(−ζωt) sin ωt

  /// A mode above the band is not observable.
  void Tune(double frequency_Hz, double damping, double sample_rate_hz) noexcept {
    if (frequency_Hz >= 0.45 * sample_rate_hz) {
      gain = strike = 0.0;
      return;
    }
    const double angle = kTwoPi * frequency_Hz / sample_rate_hz;
    const double radius = std::exp(-damping * angle);
    a1 = 2.0 * radius * std::cos(angle);
    a2 = -radius * radius;
    // Gain for which white noise of variance one comes out with variance one (AR(2) process).
    gain = std::sqrt((1.0 + a2) * ((1.0 - a2) * (1.0 - a2) - a1 * a1) / (1.0 - a2));
    strike = radius * std::sin(angle);
  }

  /// The next sample under white noise of variance one: of variance one, too.
  double Driven(double noise) noexcept { return Step(gain * noise); }
  /// The next sample after an impulse; an impulse of one rings as e^(−ζωt) sin ωt.
  double Struck(double impulse) noexcept { return Step(strike * impulse); }

 private:
  double Step(double push) noexcept {
    const double y = push + a1 * y1 + a2 * y2;
    y2 = y1;
    y1 = y;
    return y;
  }
};

}  // namespace strainwave::bench
