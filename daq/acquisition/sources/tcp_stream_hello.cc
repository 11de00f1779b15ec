// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <set>
#include <stdexcept>

#include "daq/acquisition/sources/tcp_stream_decoder.h"

namespace strainwave::daq::acquisition {
namespace {

using nlohmann::json;

constexpr double kHighestRate_hz = 1e9;
constexpr double kMostBits = 64;
constexpr double kLeastBits = 8;
constexpr std::size_t kLongestText = 1024;

const json* Find(const json& object, const char* name) {
  const auto found = object.find(name);
  return found == object.end() || found->is_null() ? nullptr : &*found;
}

std::string TextIn(const json& object, const char* name, bool is_needed) {
  const json* const value = Find(object, name);
  if (value == nullptr && !is_needed) return {};
  if (value == nullptr || !value->is_string())
    throw std::invalid_argument(fmt::format("{} is not a text", name));
  auto text = value->get<std::string>();
  if (text.size() > kLongestText)
    throw std::invalid_argument(fmt::format("{} has {} bytes", name, text.size()));
  return text;
}

double NumberIn(const json& object, const char* name, double least, double most,
                std::optional<double> absent = {}) {
  const json* const value = Find(object, name);
  if (value == nullptr && absent) return *absent;
  const double number = value != nullptr && value->is_number() ? value->get<double>() : std::nan("");
  if (!(number >= least && number <= most)) {
    throw std::invalid_argument(fmt::format("{} is not a number from {} to {}", name, least, most));
  }
  return number;
}

std::optional<double> LimitIn(const json& object, const char* name) {
  const json* const value = Find(object, name);
  if (value == nullptr) return std::nullopt;
  if (!value->is_number() || !std::isfinite(value->get<double>())) {
    throw std::invalid_argument(fmt::format("{} is not a number", name));
  }
  return value->get<double>();
}

const json& ObjectIn(const json& object, const char* name) {
  static const json none = json::object();
  const json* const value = Find(object, name);
  if (value == nullptr) return none;
  if (!value->is_object()) throw std::invalid_argument(fmt::format("{} is not an object", name));
  return *value;
}

ChannelDescription ChannelFrom(const json& channel) {
  if (!channel.is_object()) throw std::invalid_argument("a channel is not an object");
  ChannelDescription description{.name = TextIn(channel, "name", true),
                                 .unit = TextIn(channel, "unit", false),
                                 .sensor_serial = TextIn(channel, "sensor_serial", false)};
  if (description.name.empty() || description.name == "." ||
      description.name.find('/') != std::string::npos || description.name.find('\0') != std::string::npos) {
    throw std::invalid_argument(fmt::format("'{}' cannot name a channel", description.name));
  }
  Attributes texts;
  for (const auto& [name, value] : ObjectIn(channel, "calibration").items()) {
    if (!value.is_string()) throw std::invalid_argument(fmt::format("calibration: {} is not a text", name));
    texts.emplace_back(name, value.get<std::string>());
  }
  description.calibration = CalibrationFrom(texts);
  const json& limits = ObjectIn(channel, "limits");
  description.limits = {.least = LimitIn(limits, "least"),
                        .most = LimitIn(limits, "most"),
                        .saturation_low = LimitIn(limits, "saturation_low"),
                        .saturation_high = LimitIn(limits, "saturation_high"),
                        .quantum = NumberIn(limits, "quantum", 0, 1e30, 1.0),
                        .noise = NumberIn(limits, "noise", 0, 1e30, 0.0)};
  return description;
}

}  // namespace

SourceDescription SourceDescriptionFromJson(std::string_view text) {
  const json hello = json::parse(text, nullptr, false);
  if (!hello.is_object()) throw std::invalid_argument("it is not a JSON object");
  SourceDescription source;
  source.name = TextIn(hello, "name", true);
  const std::string type = TextIn(hello, "type", true);
  if (type != "int32" && type != "float32") {
    throw std::invalid_argument(fmt::format("type is '{}', neither int32 nor float32", type));
  }
  source.type = type == "int32" ? SampleType::kInt32 : SampleType::kFloat32;
  source.rate_hz = NumberIn(hello, "rate_hz", 1e-6, kHighestRate_hz);
  source.counter_bits =
      static_cast<unsigned>(NumberIn(hello, "counter_bits", kLeastBits, kMostBits, kMostBits));
  const json* const channels = Find(hello, "channels");
  if (channels == nullptr || !channels->is_array() || channels->empty() ||
      channels->size() > TcpStreamDecoder::kMostChannels) {
    throw std::invalid_argument(
        fmt::format("channels is not a list of 1 to {}", TcpStreamDecoder::kMostChannels));
  }
  const std::size_t most = TcpStreamDecoder::kMostPayload_bytes / 4 / channels->size() - 6;
  source.most_samples_a_block =
      static_cast<std::uint32_t>(NumberIn(hello, "most_samples_a_block", 1, static_cast<double>(most)));
  std::set<std::string> names;
  for (const json& channel : *channels) {
    source.channels.push_back(ChannelFrom(channel));
    if (!names.insert(source.channels.back().name).second) {
      throw std::invalid_argument(
          fmt::format("two channels have the name '{}'", source.channels.back().name));
    }
  }
  return source;
}

}  // namespace strainwave::daq::acquisition
