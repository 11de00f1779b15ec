// SPDX-License-Identifier: Apache-2.0
#include "bench/configuration/read_teds.h"

#include <array>
#include <charconv>
#include <cstdint>
#include <stdexcept>
#include <string>

#include <fmt/format.h>

#include "daq/acquisition/teds.h"

namespace strainwave::bench {

using daq::acquisition::BasicTeds;
using daq::acquisition::kBasicTeds_bytes;
using schedules::Bound;
using schedules::Presence;
using schedules::YamlMap;

namespace {

std::optional<BasicTeds> ReadBasic(YamlMap& map) {
  const std::string text = map.Text("basic");
  if (map.is_wrong("basic")) return std::nullopt;
  std::string digits;
  for (const char character : text) {
    if (character != ' ') digits += character;
  }
  std::array<std::uint8_t, kBasicTeds_bytes> bytes{};
  bool is_whole = digits.size() == 2 * bytes.size();
  for (std::size_t i = 0; is_whole && i < bytes.size(); ++i) {
    const char* const begin = digits.data() + 2 * i;
    is_whole = std::from_chars(begin, begin + 2, bytes[i], 16).ptr == begin + 2;
  }
  if (!is_whole) {
    map.AddError("basic", fmt::format("basic = '{}' is not eight bytes (expected 16 hexadecimal digits, the "
                                      "lowest byte first)",
                                      text));
    return std::nullopt;
  }
  try {
    return daq::acquisition::BasicTedsFrom(bytes);
  } catch (const std::invalid_argument& error) {
    map.AddError("basic", fmt::format("{} (expected the first 64 bits of a sensor's data sheet, the lowest "
                                      "byte first)",
                                      error.what()));
    return std::nullopt;
  }
}

daq::Attributes ReadFields(YamlMap fields) {
  daq::Attributes all;
  for (const std::string_view name : daq::acquisition::TedsTemplateFields()) {
    if (fields.has(name)) all.emplace_back(name, fields.Text(name));
  }
  fields.Finish();
  return all;
}

}  // namespace

std::optional<daq::acquisition::Calibration> ReadTeds(YamlMap& sensor) {
  YamlMap map = sensor.Map("teds", Presence::kOptional);
  std::optional<daq::acquisition::Calibration> calibration;
  if (sensor.has("teds")) {
    const std::optional<BasicTeds> basic = ReadBasic(map);
    const double counts_per_volt = map.Number("counts_per_volt", Bound::kPositive);
    const daq::Attributes fields = ReadFields(map.Map("fields", Presence::kRequired));
    if (basic && !map.is_wrong("counts_per_volt")) {
      try {
        calibration = CalibrationFromTeds(*basic, fields, counts_per_volt);
      } catch (const std::invalid_argument& error) {
        map.AddError("fields",
                     fmt::format("{} (expected the fields of the sensor's data sheet)", error.what()));
      }
    }
  }
  map.Finish();
  return calibration;
}

}  // namespace strainwave::bench
