// SPDX-License-Identifier: Apache-2.0
#include "daq/acquisition/teds.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>

#include "daq/record.h"

namespace strainwave::daq::acquisition {
namespace {

constexpr std::string_view kBasicNames[] = {"Manufacturer ID", "Model Number", "Version Letter",
                                            "Version Number", "Serial Number"};
constexpr std::string_view kTemplateNames[] = {
    "%Sens@Ref",    "%TF_HP_S",     "%Direction",     "%Weight",        "%Sign",
    "%TF_SP",       "%TF_KPr",      "%TF_KPq",        "%TF_SL",         "%TempCoef",
    "%RefFreq",     "%RefTemp",     "%CalDate",       "%CalInitials",   "%CalPeriod",
    "%MeasID",      "%ElecSigType", "%PhysMeasType",  "%MapMeth",       "%BridgeType",
    "%SensorImped", "%RespTime",    "%ExciteAmplNom", "%ExciteAmplMin", "%ExciteAmplMax"};
constexpr std::string_view kLineNames[] = {"%MinPhysVal", "%MaxPhysVal", "%MinElecVal", "%MaxElecVal"};
constexpr double kLongestPeriod_days = 4095.0;  // 12 bits

constexpr unsigned kManufacturerBits = 14;
constexpr unsigned kModelBits = 15;
constexpr unsigned kLetterBits = 5;
constexpr unsigned kVersionBits = 6;
constexpr unsigned kSerialBits = 24;
constexpr std::uint64_t kLeastManufacturer = 17;
constexpr std::uint64_t kMostManufacturer = 16381;
constexpr std::uint64_t kLetters = 26;

template <std::size_t Count>
bool IsAmong(std::string_view name, const std::string_view (&names)[Count]) {
  return std::find(std::begin(names), std::end(names), name) != std::end(names);
}

std::uint64_t DemandRange(const char* name, std::uint64_t value, std::uint64_t least, std::uint64_t most) {
  if (value >= least && value <= most) return value;
  throw std::invalid_argument(fmt::format("{} = {} is not between {} and {}", name, value, least, most));
}

// Letters count from 1, as in the five-bit characters of the standard.
std::uint64_t DemandLetter(std::uint64_t value) { return DemandRange("Version Letter", value, 1, kLetters); }

std::uint64_t LetterNumber(char letter) {
  const int number = letter - 'A' + 1;
  return static_cast<std::uint64_t>(number);
}

double NumberIn(const std::string& name, const std::string& text) {
  const std::optional<double> number = NumberFromText(text);
  if (number && std::isfinite(*number)) return *number;
  throw std::invalid_argument(fmt::format("{} = '{}' is not a finite number", name, text));
}

// As many days as the field holds.
double PeriodIn(const std::string& name, const std::string& text) {
  const double days = NumberIn(name, text);
  if (days >= 0 && days <= kLongestPeriod_days) return days;
  throw std::invalid_argument(
      fmt::format("{} = {} is not between 0 and {} days", name, text, kLongestPeriod_days));
}

// Two points of a bridge's line, as far as they are told.
struct Line {
  std::optional<double> end[std::size(kLineNames)];

  bool IsBegun() const {
    return std::any_of(std::begin(end), std::end(end), [](const auto& value) { return value.has_value(); });
  }
  // What there is of a scale: raw per unit, and raw where there is nothing to measure.
  void Scale(double raw_per_ratio, Calibration& calibration) const {
    for (std::size_t i = 0; i < std::size(kLineNames); ++i) {
      if (!end[i]) throw std::invalid_argument(fmt::format("{} of a bridge is missing", kLineNames[i]));
    }
    const double slope = (*end[3] - *end[2]) / (*end[1] - *end[0]);
    if (!std::isfinite(slope) || slope == 0) {
      throw std::invalid_argument(
          fmt::format("a bridge from {} at {} to {} at {} is no line", *end[2], *end[0], *end[3], *end[1]));
    }
    calibration.sensitivity = slope * raw_per_ratio;
    calibration.zero = (*end[2] - slope * *end[0]) * raw_per_ratio;
  }
};

}  // namespace

bool IsTedsField(std::string_view name) {
  return IsAmong(name, kBasicNames) || IsAmong(name, kTemplateNames) || IsAmong(name, kLineNames);
}

std::vector<std::string_view> TedsTemplateFields() {
  std::vector<std::string_view> names(std::begin(kTemplateNames), std::end(kTemplateNames));
  names.insert(names.end(), std::begin(kLineNames), std::end(kLineNames));
  return names;
}

BasicTeds BasicTedsFrom(std::span<const std::uint8_t, kBasicTeds_bytes> bytes) {
  std::uint64_t bits = 0;
  for (std::size_t i = 0; i < bytes.size(); ++i) bits |= std::uint64_t{bytes[i]} << (8 * i);
  const auto take = [&bits](unsigned width) {
    const std::uint64_t value = bits & ((std::uint64_t{1} << width) - 1);
    bits >>= width;
    return value;
  };
  BasicTeds teds;
  teds.manufacturer_id = static_cast<std::uint16_t>(
      DemandRange("Manufacturer ID", take(kManufacturerBits), kLeastManufacturer, kMostManufacturer));
  teds.model_number = static_cast<std::uint16_t>(take(kModelBits));
  teds.version_letter = static_cast<char>('A' + DemandLetter(take(kLetterBits)) - 1);
  teds.version_number = static_cast<std::uint8_t>(take(kVersionBits));
  teds.serial_number = static_cast<std::uint32_t>(take(kSerialBits));
  return teds;
}

std::array<std::uint8_t, kBasicTeds_bytes> BytesOf(const BasicTeds& teds) {
  std::uint64_t bits = 0;
  unsigned at = 0;
  const auto put = [&](const char* name, std::uint64_t value, unsigned width) {
    bits |= DemandRange(name, value, 0, (std::uint64_t{1} << width) - 1) << at;
    at += width;
  };
  put("Manufacturer ID",
      DemandRange("Manufacturer ID", teds.manufacturer_id, kLeastManufacturer, kMostManufacturer),
      kManufacturerBits);
  put("Model Number", teds.model_number, kModelBits);
  put("Version Letter", DemandLetter(LetterNumber(teds.version_letter)), kLetterBits);
  put("Version Number", teds.version_number, kVersionBits);
  put("Serial Number", teds.serial_number, kSerialBits);
  std::array<std::uint8_t, kBasicTeds_bytes> bytes{};
  for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<std::uint8_t>(bits >> (8 * i));
  return bytes;
}

Calibration CalibrationFromTeds(const BasicTeds& basic, const Attributes& fields, double raw_per_volt) {
  Calibration calibration;
  calibration.sensor_serial = std::to_string(basic.serial_number);
  std::optional<double> volts_per_unit;
  Line line;
  double sign = 1;
  std::optional<double> period_days;
  for (const auto& [name, text] : fields) {
    const auto* const end = std::find(std::begin(kLineNames), std::end(kLineNames), name);
    if (end != std::end(kLineNames)) {
      line.end[end - std::begin(kLineNames)] = NumberIn(name, text);
    } else if (!IsAmong(name, kTemplateNames)) {
      throw std::invalid_argument(fmt::format("'{}' is not a field of a sensor's data sheet", name));
    }
    if (name == "%Sens@Ref") volts_per_unit = NumberIn(name, text);
    if (name == "%CalPeriod") period_days = PeriodIn(name, text);
    if (name == "%CalDate") calibration.date = DateFrom(text);
    if (name == "%MapMeth" && text != "0") {
      throw std::invalid_argument(fmt::format("%MapMeth = '{}' is not the linear one, 0", text));
    }
    if (name == "%Sign" && text != "+" && text != "-") {
      throw std::invalid_argument(fmt::format("%Sign = '{}' is neither + nor -", text));
    }
    if (name == "%Sign" && text == "-") sign = -1;
  }
  if (volts_per_unit && *volts_per_unit != 0 && raw_per_volt != 0) {
    calibration.sensitivity = sign * *volts_per_unit * raw_per_volt;
  } else if (line.IsBegun() && raw_per_volt != 0) {
    line.Scale(raw_per_volt, calibration);
  } else {
    throw std::invalid_argument("%Sens@Ref is missing or 0, so that nothing can be scaled");
  }
  if (!std::isnormal(calibration.sensitivity) || !std::isfinite(calibration.zero)) {
    throw std::invalid_argument(
        fmt::format("a sensitivity of {} raw per unit is none", calibration.sensitivity));
  }
  DemandPlausible(calibration);
  if (calibration.date && period_days) {
    calibration.due = std::chrono::year_month_day(std::chrono::sys_days(*calibration.date) +
                                                  std::chrono::days(std::lround(*period_days)));
  }
  calibration.id = fmt::format("TEDS {} {}{} {}", calibration.sensor_serial, basic.version_letter,
                               static_cast<unsigned>(basic.version_number),
                               calibration.date ? TextOf(*calibration.date) : "without date");
  calibration.teds = {{"Manufacturer ID", std::to_string(basic.manufacturer_id)},
                      {"Model Number", std::to_string(basic.model_number)},
                      {"Version Letter", std::string(1, basic.version_letter)},
                      {"Version Number", std::to_string(basic.version_number)},
                      {"Serial Number", std::to_string(basic.serial_number)}};
  calibration.teds.insert(calibration.teds.end(), fields.begin(), fields.end());
  return calibration;
}

}  // namespace strainwave::daq::acquisition
