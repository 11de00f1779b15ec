// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

#include "analysis/units.h"

namespace strainwave::bench {

/// Share of a turn that is left of any number of turns, in [0, 1].
inline double FractionOfTurn(double turns) noexcept {
  // The number of turns is far inside the range of the integer.
  const double rest = turns - static_cast<double>(static_cast<long long>(turns));
  return rest < 0.0 ? rest + 1.0 : rest;
}

/// A function over one turn as a table with linear interpolation: what is read with every sample of the bench
/// must not cost a dozen sines.
class TurnTable {
 public:
  template <typename Function>
  explicit TurnTable(const Function& function) {
    for (std::size_t i = 0; i <= kEntries; ++i)
      values_[i] = function(kTwoPi * static_cast<double>(i) / kEntries);
    // A share of exactly one falls on the entry before this one.
    values_[kEntries + 1] = values_[kEntries];
  }

  double At(double turns) const noexcept {
    const double place = FractionOfTurn(turns) * kEntries;
    const auto index = static_cast<std::size_t>(static_cast<long long>(place));
    return values_[index] + (place - static_cast<double>(index)) * (values_[index + 1] - values_[index]);
  }

 private:
  static constexpr int kEntries = 1024;
  std::array<double, kEntries + 2> values_{};
};

/// Sine of an angle in turns, to 5e-6.
inline double TableSine(double turns) noexcept {
  static const TurnTable table([](double angle_rad) { return std::sin(angle_rad); });
  return table.At(turns);
}

struct TurnPhasor {
  double sine{}, cosine{1.0};
};

/// Sine and cosine of an angle in turns, as exact as the share of a turn is: the nearest entry of a table,
/// turned on by at most half an entry, for which three terms of each series are enough (1e-17).
inline TurnPhasor PhasorAtTurns(double turns) noexcept {
  constexpr int kEntries = 256;
  static const auto table = [] {
    std::array<TurnPhasor, kEntries + 1> phasors;
    for (int i = 0; i <= kEntries; ++i) {
      const double angle_rad = kTwoPi * static_cast<double>(i) / kEntries;
      phasors[static_cast<std::size_t>(i)] = {std::sin(angle_rad), std::cos(angle_rad)};
    }
    return phasors;
  }();
  const double place = FractionOfTurn(turns) * kEntries;
  const auto nearest = static_cast<long long>(place + 0.5);
  const double rest_rad = (place - static_cast<double>(nearest)) * (kTwoPi / kEntries);
  const double square = rest_rad * rest_rad;
  const double sine = rest_rad * (1.0 - square / 6.0 * (1.0 - square / 20.0));
  const double cosine = 1.0 - square / 2.0 * (1.0 - square / 12.0 * (1.0 - square / 30.0));
  const TurnPhasor& entry = table[static_cast<std::size_t>(nearest)];
  return {entry.sine * cosine + entry.cosine * sine, entry.cosine * cosine - entry.sine * sine};
}

}  // namespace strainwave::bench
