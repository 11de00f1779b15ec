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

}  // namespace strainwave::bench
