// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

namespace strainwave::bench {

/// A signal that comes out a fixed time after it went in, for steps that hardly ever change their length.
/// What does not fit (steps shorter than the delay / 254) comes out earlier.
class DelayLine {
 public:
  DelayLine() = default;
  explicit DelayLine(double delay_s) : delay_s_(delay_s) {}

  bool delays() const noexcept { return delay_s_ > 0.0; }

  /// Takes in the value of this step and gives out the one of `delay_s` ago, between steps by interpolation.
  double Next(double value, double step_s) noexcept {
    newest_ = (newest_ + 1) % kPlaces;
    values_[newest_] = value;
    const double back = std::min(delay_s_ / step_s, static_cast<double>(kPlaces - 2));
    const auto whole = static_cast<std::size_t>(back);
    const double share = back - static_cast<double>(whole);
    const double near = values_[(newest_ + kPlaces - whole) % kPlaces];
    const double far = values_[(newest_ + kPlaces - whole - 1) % kPlaces];
    return near + share * (far - near);
  }

  void Clear() noexcept {
    if (delays()) values_ = {};
  }

 private:
  static constexpr std::size_t kPlaces = 256;
  double delay_s_{};
  std::array<double, kPlaces> values_{};
  std::size_t newest_{};
};

}  // namespace strainwave::bench
