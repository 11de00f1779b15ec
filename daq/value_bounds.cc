// SPDX-License-Identifier: Apache-2.0
#include "daq/value_bounds.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

namespace strainwave::daq {
namespace {

// Each far beyond what any reducer, axis or sensor does, and far below where squares and cubes end.
constexpr ValueBounds kBounds[] = {
    {"s", -1e11, 1e11},         // 3000 years: seconds since 1970, 1904 or 1601
    {"deg", -1e12, 1e12},       // 3e9 turns; beyond, a double steps by more than half an arcsecond
    {"rad", -1e11, 1e11},       // about the same turns
    {"arcmin", -1e14, 1e14},    // the same
    {"arcsec", -1e16, 1e16},    // the same
    {"m", -1e7, 1e7},           // 10 000 km
    {"mm", -1e10, 1e10},        // the same
    {"rpm", -1e7, 1e7},         // the fastest spindles turn at 1e6
    {"rad/s", -1e7, 1e7},       // 1e8 rpm
    {"deg/s", -1e9, 1e9},       // the same
    {"m/s", -1e6, 1e6},         // no axis moves as fast as a satellite
    {"m/s^2", -1e7, 1e7},       // shock sensors end at 1e6
    {"g", -1e6, 1e6},           // the same
    {"Nm", -1e6, 1e6},          // harmonic drives give up to 1e4, test stands 1e5
    {"N", -1e8, 1e8},           // 10 000 t
    {"A", -1e6, 1e6},           // far beyond any inverter of an axis
    {"V", -1e6, 1e6},           // the same
    {"W", -1e9, 1e9},           // the same
    {"degC", -273.15, 5000.0},  // from absolute zero; tungsten melts at 3400
    {"hz", 1e-6, 1e9},          // a sample in 12 days to one in a nanosecond
    {"Hz", -1e9, 1e9},          // a frequency that was measured may be zero
    {"Nm/rad", -1e12, 1e12},    // 1e6 Nm over a microradian
    {"Nm/A", -1e6, 1e6},        // 1e6 Nm of one ampere
    {"N/A", -1e8, 1e8},         // likewise
    {"kgm^2", 0.0, 1e9},        // a wheel of 10 000 t and 10 m
    {"kg", 0.0, 1e9},           // the heaviest things that move
};
// A ratio has no unit in its name: worm and cycloid trains end at 1e5.
constexpr ValueBounds kRatio{"", -1e6, 1e6};
// Counters and times in nanoseconds are below 1e20; the sum of 1e9 cubes is still far from the end of a
// double.
constexpr ValueBounds kAnything{"", -1e30, 1e30};

}  // namespace

std::string UnitOf(std::string_view column) {
  if (column == "direction") return {};
  const auto take_last_word = [&column] {
    const std::size_t underscore = column.rfind('_');
    const std::string_view word = underscore == column.npos ? column : column.substr(underscore + 1);
    column = underscore == column.npos ? std::string_view{} : column.substr(0, underscore);
    return word;
  };
  std::string unit(take_last_word());
  if (column.empty() || unit.empty()) return {};  // a name of one word has no unit in it
  if (const char last = unit.back(); unit.size() > 1 && (last == '2' || last == '3')) {
    unit.back() = '^';
    unit += last;
  }
  if (column.ends_with("_per")) {
    column.remove_suffix(4);
    return fmt::format("{}/{}", take_last_word(), unit);
  }
  return unit;
}

std::string ValueBounds::Text() const {
  return fmt::format("a number from {:g} to {:g}{}{}", least, most, unit.empty() ? "" : " ", unit);
}

const ValueBounds& BoundsOf(std::string_view name) {
  if (name == "ratio") return kRatio;
  const std::string unit = UnitOf(name);
  const auto* const found = std::ranges::find(kBounds, std::string_view(unit), &ValueBounds::unit);
  return found == std::end(kBounds) ? kAnything : *found;
}

std::optional<std::size_t> FindImplausible(std::span<const double> values, const ValueBounds& bounds) {
  const auto found = std::ranges::find_if_not(values, [&](double value) { return bounds.Hold(value); });
  if (found == values.end()) return std::nullopt;
  return static_cast<std::size_t>(found - values.begin());
}

}  // namespace strainwave::daq
