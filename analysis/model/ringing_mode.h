// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <numbers>
#include <stdexcept>
#include <vector>

namespace strainwave::analysis::model {

/// A mode of a structure, step by step: an impact of 1 makes it ring as e^(−ζωt) sin(ω√(1 − ζ²) t), exact at
/// the samples.
class RingingMode {
 public:
  RingingMode(double frequency_Hz, double damping, double sample_rate_hz) {
    const double angle = 2.0 * std::numbers::pi * frequency_Hz / sample_rate_hz;
    const double decay = std::exp(-damping * angle);
    const double damped = angle * std::sqrt(1.0 - damping * damping);
    first_ = 2.0 * decay * std::cos(damped);
    second_ = -decay * decay;
    gain_ = decay * std::sin(damped);
  }

  /// @param impact  at this sample; it is felt from the next one on.
  /// @return the response at this sample.
  double Step(double impact) {
    const double now = first_ * last_ + second_ * before_ + gain_ * impact_;
    before_ = last_;
    last_ = now;
    impact_ = impact;
    return now;
  }

 private:
  double first_{};
  double second_{};
  double gain_{};
  double last_{};
  double before_{};
  double impact_{};
};

/// What stands before a converter that must not fold: a Butterworth low-pass of even order.
class ButterworthLowPass {
 public:
  /// @param cutoff_Hz  where the power is halved; below half the sample rate.
  /// @throws std::invalid_argument for an odd order, or a cutoff out of range.
  /// Source: Oppenheim & Schafer, Discrete-Time Signal Processing, section 7.2 (bilinear transform).
  ButterworthLowPass(int order, double cutoff_Hz, double sample_rate_hz) {
    if (order < 2 || order % 2 != 0 || !(cutoff_Hz > 0.0 && cutoff_Hz < 0.5 * sample_rate_hz))
      throw std::invalid_argument("a low-pass takes an even order and a cutoff below half the sample rate");
    const double warped = std::tan(std::numbers::pi * cutoff_Hz / sample_rate_hz);
    for (int pair = 0; pair < order / 2; ++pair) {
      const double damping = std::sin(std::numbers::pi * (2.0 * pair + 1.0) / (2.0 * order));
      const double scale = 1.0 / (1.0 + 2.0 * damping * warped + warped * warped);
      sections_.push_back({.gain = warped * warped * scale,
                           .first = 2.0 * (warped * warped - 1.0) * scale,
                           .second = (1.0 - 2.0 * damping * warped + warped * warped) * scale});
    }
  }

  double Step(double value) {
    for (Section& section : sections_) {
      const double sum = value - section.first * section.one - section.second * section.two;
      value = section.gain * (sum + 2.0 * section.one + section.two);
      section.two = section.one;
      section.one = sum;
    }
    return value;
  }

 private:
  struct Section {
    double gain{};
    double first{};
    double second{};
    double one{};  // sums of the last two steps
    double two{};
  };
  std::vector<Section> sections_;
};

}  // namespace strainwave::analysis::model
