// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>

/// What a quantity can plausibly be, by the unit that its name ends in. Whatever comes in from outside is
/// held against it, so that the mathematics behind may square, cube and sum what it is given.
namespace strainwave::daq {

/// The unit that a column's name ends in, as a text for people: "Nm", "deg", "m/s^2"; empty for `direction`.
std::string UnitOf(std::string_view column);

struct ValueBounds {
  std::string_view unit;  // as `UnitOf` says it; empty for any other
  double least{};
  double most{};

  /// False for NaN.
  bool Hold(double value) const { return value >= least && value <= most; }
  /// "a number from -1e+07 to 1e+07 m/s^2", for a message.
  std::string Text() const;
};

/// The bounds for values of a column, a metadata key or a channel of that name.
const ValueBounds& BoundsOf(std::string_view name);

/// The place of the first value that is no number or out of bounds; nothing where all are good.
std::optional<std::size_t> FindImplausible(std::span<const double> values, const ValueBounds& bounds);

}  // namespace strainwave::daq
