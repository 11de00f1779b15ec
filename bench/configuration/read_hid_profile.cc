// SPDX-License-Identifier: Apache-2.0
#include "bench/configuration/read_hid_profile.h"

#include <charconv>
#include <cmath>
#include <optional>
#include <sstream>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "bench/configuration/bench_bounds.h"
#include "bench/configuration/device_file.h"
#include "schedules/reader/yaml_map.h"

namespace strainwave::bench {
namespace {

using protocols::HidField;
using schedules::Bound;
using schedules::Dimension;
using schedules::FindingList;
using schedules::Presence;
using schedules::ReadContext;
using schedules::YamlMap;
using schedules::YamlNode;

constexpr schedules::FileKind kHidFile{"HID device", "hid_device: 1"};
constexpr int kMostReportBytes = 1024;

std::optional<unsigned> Hexadecimal(std::string_view text, unsigned most) {
  unsigned number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number, 16);
  if (error != std::errc{} || end != text.data() + text.size() || number > most) return std::nullopt;
  return number;
}

// As lsusb prints it: four hexadecimal digits.
std::uint16_t ReadNumber(YamlMap& map, std::string_view key) {
  const std::string text = map.Text(key);
  const auto number = text.size() == 4 ? Hexadecimal(text, 0xFFFF) : std::nullopt;
  if (!number && !map.is_wrong(key)) {
    map.AddError(key,
                 fmt::format("{} = {} is not usable (expected four hexadecimal digits, as lsusb prints them)",
                             key, text));
  }
  return static_cast<std::uint16_t>(number.value_or(0));
}

std::vector<std::uint8_t> ReadBytes(YamlMap& map, std::string_view key) {
  std::istringstream words(map.Text(key, ""));
  std::vector<std::uint8_t> bytes;
  for (std::string word; words >> word;) {
    const auto byte = Hexadecimal(word, 0xFF);
    if (!byte) {
      map.AddError(
          key,
          fmt::format("{} has '{}' (expected bytes of two hexadecimal digits, as in '00 80 33')", key, word));
      return {};
    }
    bytes.push_back(static_cast<std::uint8_t>(*byte));
  }
  return bytes;
}

std::optional<double> OptionalNumber(YamlMap& map, std::string_view key) {
  const double number = map.has(key) ? map.Number(key, Bound::kAny) : map.Number(key, Bound::kAny, "0");
  return map.has(key) ? std::optional(number) : std::nullopt;
}

HidField ReadField(YamlMap& map) {
  HidField field;
  field.name = map.Identifier("name");
  field.report_id = static_cast<std::uint8_t>(map.Count("report_id", 0, 255, "0"));
  field.report_length = static_cast<std::size_t>(map.Count("report_length", 1, kMostReportBytes));
  field.first_bit = static_cast<unsigned>(map.Count("first_bit", 0, 8 * kMostReportBytes));
  field.bits = static_cast<unsigned>(map.Count("bits", 1, 32));
  field.is_signed = map.Flag("signed", "false");
  field.high_byte_first = map.Flag("high_byte_first", "false");
  field.scale = map.Number("scale", Bound::kNotZero, "1");
  field.offset = map.Number("offset", Bound::kAny, "0");
  field.unit = map.Text("unit", "");
  field.least = OptionalNumber(map, "least");
  field.most = OptionalNumber(map, "most");
  map.Finish();
  if (const std::string problem = CheckField(field); !problem.empty()) map.AddError("bits", problem);
  return field;
}

HidProfile ReadHidDevice(const YamlNode& root, ReadContext& context) {
  const auto nanoseconds = [](double time_s) { return std::chrono::nanoseconds(std::llround(time_s * 1e9)); };
  context.bounds = DeviceBounds();
  YamlMap map(root, context);
  map.Version("hid_device");
  HidProfile profile;
  profile.name = map.Text("device");
  profile.device.vendor = ReadNumber(map, "vendor");
  profile.device.product = ReadNumber(map, "product");
  profile.device.serial = map.Text("serial", "");
  profile.device.request = ReadBytes(map, "request");
  profile.device.request_period =
      nanoseconds(map.Quantity("request_period", Dimension::kTime, Bound::kPositive, "1 s"));
  profile.good_for = nanoseconds(map.Quantity("good_for", Dimension::kTime, Bound::kPositive));
  for (YamlMap& channel : map.MapList("channels", Presence::kRequired)) {
    profile.channels.push_back(ReadField(channel));
  }
  map.Finish();
  return profile;
}

}  // namespace

HidProfile ReadHidProfile(const std::filesystem::path& path) {
  return ParseHidProfile(TextOfFile<HidProfileError>(path, kHidFile), path.string());
}

HidProfile ParseHidProfile(const std::string& text, std::string_view file_name) {
  return ParseFile<HidProfileError>(text, file_name, kHidFile, ReadHidDevice);
}

}  // namespace strainwave::bench
