// SPDX-License-Identifier: Apache-2.0
#include "daq/import/units.h"

#include <algorithm>
#include <numbers>

#include <fmt/format.h>

#include "daq/csv_text.h"

namespace strainwave::daq {
namespace {

struct Row {
  std::string_view text;
  ImportUnit unit;
};

constexpr double kPi = std::numbers::pi;
constexpr double kGravity = 9.80665;  // exact, CGPM 1901

// The first of each quantity's spellings stands in messages.
constexpr Row kUnits[] = {
    {"s", {"time"}},
    {"ms", {"time", 1e-3}},
    {"us", {"time", 1e-6}},
    {"µs", {"time", 1e-6}},
    {"μs", {"time", 1e-6}},
    {"ns", {"time", 1e-9}},
    {"min", {"time", 60.0}},
    {"h", {"time", 3600.0}},
    {"sec", {"time"}},
    {"rad", {"angle"}},
    {"deg", {"angle", kPi / 180.0}},
    {"mrad", {"angle", 1e-3}},
    {"urad", {"angle", 1e-6}},
    {"arcmin", {"angle", kPi / 10800.0}},
    {"arcsec", {"angle", kPi / 648000.0}},
    {"rev", {"angle", 2.0 * kPi}},
    {"µrad", {"angle", 1e-6}},
    {"°", {"angle", kPi / 180.0}},
    {"degree", {"angle", kPi / 180.0}},
    {"degrees", {"angle", kPi / 180.0}},
    {"turn", {"angle", 2.0 * kPi}},
    {"'", {"angle", kPi / 10800.0}},
    {"\"", {"angle", kPi / 648000.0}},
    {"Nm", {"torque"}},
    {"mNm", {"torque", 1e-3}},
    {"kNm", {"torque", 1e3}},
    {"Ncm", {"torque", 1e-2}},
    {"Nmm", {"torque", 1e-3}},
    {"lbf.ft", {"torque", 1.3558179483314004}},
    {"lbf.in", {"torque", 0.1129848290276167}},
    {"N.m", {"torque"}},
    {"N·m", {"torque"}},
    {"N⋅m", {"torque"}},
    {"N*m", {"torque"}},
    {"N m", {"torque"}},
    {"A", {"current"}},
    {"mA", {"current", 1e-3}},
    {"V", {"voltage"}},
    {"mV", {"voltage", 1e-3}},
    {"W", {"power"}},
    {"kW", {"power", 1e3}},
    {"rad/s", {"angular speed"}},
    {"rpm", {"angular speed", kPi / 30.0}},
    {"deg/s", {"angular speed", kPi / 180.0}},
    {"°/s", {"angular speed", kPi / 180.0}},
    {"1/min", {"angular speed", kPi / 30.0}},
    {"min-1", {"angular speed", kPi / 30.0}},
    {"min^-1", {"angular speed", kPi / 30.0}},
    {"U/min", {"angular speed", kPi / 30.0}},
    {"rad/s^2", {"angular acceleration"}},
    {"rad/s2", {"angular acceleration"}},
    {"rad/s²", {"angular acceleration"}},
    {"deg/s^2", {"angular acceleration", kPi / 180.0}},
    {"m/s^2", {"acceleration"}},
    {"g", {"acceleration", kGravity}},
    {"mm/s^2", {"acceleration", 1e-3}},
    {"m/s2", {"acceleration"}},
    {"m/s²", {"acceleration"}},
    {"m/s/s", {"acceleration"}},
    {"m/sec^2", {"acceleration"}},
    {"mm/s²", {"acceleration", 1e-3}},
    {"gn", {"acceleration", kGravity}},
    {"mg", {"acceleration", 1e-3 * kGravity}},
    {"m", {"length"}},
    {"mm", {"length", 1e-3}},
    {"um", {"length", 1e-6}},
    {"µm", {"length", 1e-6}},
    {"m/s", {"speed"}},
    {"mm/s", {"speed", 1e-3}},
    {"N", {"force"}},
    {"kN", {"force", 1e3}},
    {"degC", {"temperature"}},
    {"K", {"temperature", 1.0, -273.15}},
    {"degF", {"temperature", 5.0 / 9.0, -160.0 / 9.0}},
    {"°C", {"temperature"}},
    {"C", {"temperature"}},
    {"°F", {"temperature", 5.0 / 9.0, -160.0 / 9.0}},
    {"Hz", {"frequency"}},
    {"hz", {"frequency"}},
    {"kHz", {"frequency", 1e3}},
    {"MHz", {"frequency", 1e6}},
    {"Pa", {"pressure"}},
    {"bar", {"pressure", 1e5}},
};

std::string_view Bare(std::string_view text) {
  text = Trim(text);
  for (const auto& [open, close] : {std::pair{'[', ']'}, {'(', ')'}}) {
    if (text.size() >= 2 && text.front() == open && text.back() == close)
      return Trim(text.substr(1, text.size() - 2));
  }
  return text;
}

}  // namespace

std::optional<ImportUnit> FindImportUnit(std::string_view text) {
  const std::string_view bare = Bare(text);
  const auto* const found = std::ranges::find(kUnits, bare, &Row::text);
  if (found == std::end(kUnits)) return std::nullopt;
  return found->unit;
}

std::optional<UnitChange> ChangeOfUnit(std::string_view from, std::string_view to) {
  if (Bare(from) == Bare(to)) return UnitChange{};
  const std::optional<ImportUnit> source = FindImportUnit(from);
  const std::optional<ImportUnit> target = FindImportUnit(to);
  if (!source || !target || source->quantity != target->quantity) return std::nullopt;
  return UnitChange{source->scale / target->scale, (source->offset - target->offset) / target->scale};
}

std::string UnitsLike(std::string_view unit) {
  const std::optional<ImportUnit> like = FindImportUnit(unit);
  if (!like) return std::string(unit);
  std::string text;
  std::vector<double> told;
  for (const Row& row : kUnits) {
    if (row.unit.quantity != like->quantity || std::ranges::find(told, row.unit.scale) != told.end())
      continue;
    told.push_back(row.unit.scale);
    text += fmt::format("{}{}", text.empty() ? "" : ", ", row.text);
  }
  return text;
}

NamedUnit SplitUnit(std::string_view name) {
  name = Trim(name);
  for (const auto& [open, close] : {std::pair{'[', ']'}, {'(', ')'}}) {
    if (name.empty() || name.back() != close) continue;
    const std::size_t at = name.rfind(open);
    if (at == name.npos || at == 0) continue;
    const std::string_view unit = Trim(name.substr(at + 1, name.size() - at - 2));
    if (unit.find(':') != unit.npos && unit.find_first_not_of("0123456789,: ") == unit.npos) continue;
    return {Trim(name.substr(0, at)), unit};
  }
  return {};
}

}  // namespace strainwave::daq
