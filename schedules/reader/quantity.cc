// SPDX-License-Identifier: Apache-2.0
#include "schedules/reader/quantity.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <span>
#include <stdexcept>
#include <system_error>
#include <vector>

#include "analysis/units.h"
#include "schedules/reader/unicode_spaces.h"
#include "schedules/reader/wording.h"

namespace strainwave::schedules {
namespace {

struct Unit {
  std::string_view symbol;
  double factor;  // to SI
  bool listed = true;
};

constexpr double kStandardGravity_m_per_s2 = 9.80665;  // exact by definition
constexpr double kAbsoluteZero_degC = -273.15;

constexpr Unit kTimes[] = {{"us", 1e-6},  {"ms", 1e-3},   {"s", 1.0},          {"min", 60.0},
                           {"h", 3600.0}, {"d", 86400.0}, {"µs", 1e-6, false}, {"μs", 1e-6, false}};
constexpr Unit kAngles[] = {{"arcsec", RadFromArcsec(1.0)},
                            {"arcmin", RadFromArcmin(1.0)},
                            {"deg", RadFromDeg(1.0)},
                            {"rad", 1.0},
                            {"mrad", 1e-3},
                            {"rev", kTwoPi},
                            {"°", RadFromDeg(1.0), false}};
constexpr Unit kAngularSpeeds[] = {{"rpm", RadPerSFromRpm(1.0)}, {"rad/s", 1.0}, {"deg/s", RadFromDeg(1.0)}};
constexpr Unit kAngularAccelerations[] = {{"rad/s2", 1.0},
                                          {"deg/s2", RadFromDeg(1.0)},
                                          {"rpm/s", RadPerSFromRpm(1.0)},
                                          {"rad/s^2", 1.0, false},
                                          {"rad/s²", 1.0, false}};
constexpr Unit kTorques[] = {{"Nm", 1.0},  {"mNm", 1e-3},       {"Ncm", 1e-2},
                             {"kNm", 1e3}, {"N·m", 1.0, false}, {"N⋅m", 1.0, false}};
constexpr Unit kTorqueRates[] = {
    {"Nm/s", 1.0}, {"Nm/min", 1.0 / 60.0}, {"N·m/s", 1.0, false}, {"N⋅m/s", 1.0, false}};
constexpr Unit kFrequencies[] = {{"Hz", 1.0}, {"kHz", 1e3}};
constexpr Unit kTemperatures[] = {{"degC", 1.0}, {"°C", 1.0, false}};
constexpr Unit kTemperatureDifferences[] = {{"K", 1.0}};
constexpr Unit kAccelerations[] = {
    {"m/s2", 1.0}, {"g", kStandardGravity_m_per_s2}, {"m/s^2", 1.0, false}, {"m/s²", 1.0, false}};
constexpr Unit kSensitivities[] = {{"mV/g", 1e-3 / kStandardGravity_m_per_s2}, {"mV/(m/s2)", 1e-3}};
constexpr Unit kShares[] = {{"%", 1e-2}};

struct DimensionEntry {
  std::string_view name;
  std::string_view example;
  std::span<const Unit> units;
};

DimensionEntry Entry(Dimension dimension) {
  switch (dimension) {
    case Dimension::kTime:
      return {"time", "30 min", kTimes};
    case Dimension::kAngle:
      return {"angle", "1 deg", kAngles};
    case Dimension::kAngularSpeed:
      return {"speed", "2400 rpm", kAngularSpeeds};
    case Dimension::kAngularAcceleration:
      return {"angular acceleration", "1000 rad/s2", kAngularAccelerations};
    case Dimension::kTorque:
      return {"torque", "40 Nm", kTorques};
    case Dimension::kTorqueRate:
      return {"torque rate", "200 Nm/s", kTorqueRates};
    case Dimension::kFrequency:
      return {"frequency", "25.6 kHz", kFrequencies};
    case Dimension::kTemperature:
      return {"temperature", "60 degC", kTemperatures};
    case Dimension::kTemperatureDifference:
      return {"temperature difference", "5 K", kTemperatureDifferences};
    case Dimension::kAcceleration:
      return {"acceleration", "3 m/s2", kAccelerations};
    case Dimension::kSensitivity:
      return {"sensitivity", "100 mV/g", kSensitivities};
    case Dimension::kShare:
      return {"share", "70 %", kShares};
  }
  throw std::invalid_argument(
      fmt::format("dimension = {} is not one of the enumeration", static_cast<int>(dimension)));
}

std::string_view Trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(' ');
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(' ') - first + 1);
}

// What stands before the unit, or nothing if `text` does not begin with a decimal number.
struct LeadingNumber {
  double value{};
  std::string_view rest;
  bool found{false};
  bool in_range{true};
};

LeadingNumber TakeNumber(std::string_view text) {
  // from_chars takes no '+', and reads "inf" and "nan", which are words here.
  const std::size_t first = text.starts_with('-') || text.starts_with('+') ? 1 : 0;
  if (first >= text.size() || !(text[first] == '.' || (text[first] >= '0' && text[first] <= '9'))) return {};
  if (text[0] == '+') text.remove_prefix(1);
  LeadingNumber number;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number.value);
  if (error == std::errc::invalid_argument) return {};
  number.found = true;
  number.in_range = error == std::errc{};
  number.rest = text.substr(static_cast<std::size_t>(end - text.data()));
  return number;
}

// "55,5 Nm", as it is written in many countries.
void RefuseComma(std::string_view text, const LeadingNumber& number) {
  const std::string_view rest = number.rest;
  if (rest.size() < 2 || rest[0] != ',' || rest[1] < '0' || rest[1] > '9') return;
  std::string with_point(text);
  with_point[text.size() - rest.size()] = '.';
  throw std::invalid_argument(fmt::format("decimal comma (expected a point, as in '{}')", with_point));
}

}  // namespace

std::string DimensionName(Dimension dimension) {
  const std::string_view name = Entry(dimension).name;
  return fmt::format("{} {}", name.starts_with('a') ? "an" : "a", name);
}

std::string AcceptedUnits(Dimension dimension) {
  std::vector<std::string_view> symbols;
  for (const Unit& unit : Entry(dimension).units) {
    if (unit.listed) symbols.push_back(unit.symbol);
  }
  return Alternatives(symbols);
}

double ParseQuantity(std::string_view text, Dimension dimension) {
  const DimensionEntry entry = Entry(dimension);
  const std::string plain = WithPlainSpaces(text);
  const LeadingNumber number = TakeNumber(Trimmed(plain));
  if (!number.found) {
    throw std::invalid_argument(fmt::format("not a number with a unit{} (expected {}, as in '{}')",
                                            NonAsciiIn(plain), DimensionName(dimension), entry.example));
  }
  RefuseComma(Trimmed(plain), number);
  const std::string_view symbol = Trimmed(number.rest);
  double factor = 1.0;
  if (symbol.empty()) {
    if (dimension != Dimension::kShare) {
      throw std::invalid_argument(fmt::format("no unit (expected {})", AcceptedUnits(dimension)));
    }
  } else {
    const Unit* match = nullptr;
    for (const Unit& unit : entry.units) {
      if (unit.symbol == symbol) match = &unit;
    }
    if (match == nullptr) {
      throw std::invalid_argument(fmt::format("'{}'{} is not a unit of {} (expected {})", symbol,
                                              NonAsciiIn(symbol), entry.name, AcceptedUnits(dimension)));
    }
    factor = match->factor;
  }
  const double value = number.value * factor;
  if (!number.in_range || !std::isfinite(value)) {
    throw std::invalid_argument(
        fmt::format("out of range (expected {}, as in '{}')", DimensionName(dimension), entry.example));
  }
  if (dimension == Dimension::kTemperature && value < kAbsoluteZero_degC) {
    throw std::invalid_argument("below absolute zero (expected a temperature above -273.15 degC)");
  }
  return value;
}

double ParseNumber(std::string_view text) {
  const std::string plain = WithPlainSpaces(text);
  const LeadingNumber number = TakeNumber(Trimmed(plain));
  if (!number.found) {
    throw std::invalid_argument(
        fmt::format("not a number{} (expected a plain number, as in '0.5')", NonAsciiIn(plain)));
  }
  RefuseComma(Trimmed(plain), number);
  if (!number.rest.empty()) {
    throw std::invalid_argument(
        fmt::format("'{}' after the number (expected a plain number)", Trimmed(number.rest)));
  }
  if (!number.in_range) throw std::invalid_argument("out of range (expected a plain number)");
  return number.value;
}

}  // namespace strainwave::schedules
