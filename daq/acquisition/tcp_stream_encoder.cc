// SPDX-License-Identifier: Apache-2.0
#include "daq/acquisition/tcp_stream_encoder.h"

#include <bit>
#include <cstring>
#include <span>
#include <string>

#include <nlohmann/json.hpp>

#include "daq/crc32.h"

namespace strainwave::daq::acquisition {
namespace {

using nlohmann::json;

// Numbers go out as they lie in memory.
static_assert(std::endian::native == std::endian::little);

constexpr std::uint8_t kHello = 1;
constexpr std::uint8_t kBlock = 2;
constexpr std::uint8_t kKeepAlive = 3;
constexpr std::uint8_t kVersion = 1;
constexpr std::size_t kHeader_bytes = 20;

template <typename Number>
void Append(std::vector<std::byte>& bytes, Number number) {
  const std::size_t at = bytes.size();
  bytes.resize(at + sizeof number);
  std::memcpy(bytes.data() + at, &number, sizeof number);
}

void Begin(std::vector<std::byte>& message) { message.assign(kHeader_bytes, std::byte{}); }

// The header, once the payload stands behind the room that `Begin` left for it.
void Finish(std::vector<std::byte>& message, std::uint8_t type) {
  std::byte* const head = message.data();
  std::memcpy(head, "SWS1", 4);
  head[4] = std::byte{type};
  head[5] = std::byte{kVersion};
  const auto length = static_cast<std::uint32_t>(message.size() - kHeader_bytes);
  std::memcpy(head + 8, &length, sizeof length);
  const std::uint32_t header_crc = Crc32(std::span(message).first(12));
  std::memcpy(head + 12, &header_crc, sizeof header_crc);
  const std::uint32_t payload_crc = Crc32(std::span(message).subspan(kHeader_bytes));
  std::memcpy(head + 16, &payload_crc, sizeof payload_crc);
}

json JsonOf(const ChannelDescription& channel) {
  json object{{"name", channel.name}, {"unit", channel.unit}};
  if (!channel.sensor_serial.empty()) object["sensor_serial"] = channel.sensor_serial;
  json calibration = json::object();
  for (const auto& [name, text] : AttributesOf(channel.calibration)) calibration[name] = text;
  if (!calibration.empty()) object["calibration"] = calibration;
  json limits{{"quantum", channel.limits.quantum}, {"noise", channel.limits.noise}};
  const auto add = [&](const char* name, const std::optional<double>& limit) {
    if (limit) limits[name] = *limit;
  };
  add("least", channel.limits.least);
  add("most", channel.limits.most);
  add("saturation_low", channel.limits.saturation_low);
  add("saturation_high", channel.limits.saturation_high);
  object["limits"] = limits;
  return object;
}

}  // namespace

std::vector<std::byte> EncodeHello(const SourceDescription& description) {
  json channels = json::array();
  for (const ChannelDescription& channel : description.channels) channels.push_back(JsonOf(channel));
  const std::string text = json{
      {"name", description.name},
      {"type", description.type == SampleType::kInt32 ? "int32" : "float32"},
      {"rate_hz", description.rate_hz},
      {"counter_bits", description.counter_bits},
      {"most_samples_a_block", description.most_samples_a_block},
      {"channels", channels}}.dump();
  std::vector<std::byte> message;
  Begin(message);
  message.resize(kHeader_bytes + text.size());
  std::memcpy(message.data() + kHeader_bytes, text.data(), text.size());
  Finish(message, kHello);
  return message;
}

void EncodeBlock(const SampleBlock& block, std::vector<std::byte>& message) {
  Begin(message);
  Append(message, block.header.device_counter);
  Append(message, std::int64_t{block.header.device_time.count()});
  Append(message, block.header.samples);
  Append(message, std::uint32_t{(block.header.flags & kDeviceOverrun) != 0 ? 1U : 0U});
  const std::span<const std::uint32_t> words = block.words();
  const std::size_t at = message.size();
  message.resize(at + words.size_bytes());
  std::memcpy(message.data() + at, words.data(), words.size_bytes());
  Finish(message, kBlock);
}

std::vector<std::byte> EncodeKeepAlive(std::uint64_t counter, std::chrono::nanoseconds device_time) {
  std::vector<std::byte> message;
  Begin(message);
  Append(message, counter);
  Append(message, std::int64_t{device_time.count()});
  Finish(message, kKeepAlive);
  return message;
}

}  // namespace strainwave::daq::acquisition
