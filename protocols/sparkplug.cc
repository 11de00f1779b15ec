// SPDX-License-Identifier: Apache-2.0
#include "protocols/sparkplug.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include <nlohmann/json.hpp>

#include "protocols/sparkplug_b.pb.h"

namespace strainwave::protocols {
namespace {

using sparkplug_b::Payload;

// Data types of the specification, chapter 6.4.16.
enum DataType : std::uint32_t {
  kInt32 = 3,
  kInt64 = 4,
  kUInt64 = 8,
  kDouble = 10,
  kBoolean = 11,
  kString = 12
};

constexpr int kNumbers = 256;
constexpr std::string_view kBirthDeathNumber = "bdSeq";
constexpr std::string_view kQuality = "Quality";
constexpr std::string_view kRebirth = "Node Control/Rebirth";
// What a host says takes a hundred bytes; a broker passes on 256 MB.
constexpr std::size_t kLongestWord_bytes = 4096;
constexpr std::size_t kLongestCommand_bytes = std::size_t{1} << 20U;

void RequireTopicName(const char* what, const std::string& name) {
  if (name.empty() || name.find_first_of("/+#") != std::string::npos) {
    throw std::invalid_argument(std::string(what) + " = '" + name +
                                "' cannot be part of a topic (expected a name without '/', '+' and '#')");
  }
}

struct ValueWriter {
  Payload::Metric& metric;
  bool is_null;

  void operator()(double value) const {
    metric.set_datatype(kDouble);
    if (!is_null) metric.set_double_value(value);
  }
  void operator()(std::int64_t value) const {
    metric.set_datatype(kInt64);
    if (!is_null) metric.set_long_value(static_cast<std::uint64_t>(value));  // two's complement, 6.4.16
  }
  void operator()(bool value) const {
    metric.set_datatype(kBoolean);
    if (!is_null) metric.set_boolean_value(value);
  }
  void operator()(const std::string& value) const {
    metric.set_datatype(kString);
    if (!is_null) metric.set_string_value(value);
  }
};

void Add(Payload& payload, const SparkplugMetric& from) {
  Payload::Metric& metric = *payload.add_metrics();
  metric.set_name(from.name);
  metric.set_timestamp(static_cast<std::uint64_t>(from.time_ms));
  if (from.is_historical) metric.set_is_historical(true);
  if (from.is_null) metric.set_is_null(true);
  if (from.quality) {
    metric.mutable_properties()->add_keys(std::string(kQuality));
    Payload::PropertyValue& value = *metric.mutable_properties()->add_values();
    value.set_type(kInt32);
    value.set_int_value(static_cast<std::uint32_t>(*from.quality));
  }
  std::visit(ValueWriter{metric, from.is_null}, from.value);
}

void AddBirthDeathNumber(Payload& payload, int number) {
  Payload::Metric& metric = *payload.add_metrics();
  metric.set_name(std::string(kBirthDeathNumber));
  metric.set_datatype(kInt64);
  metric.set_long_value(static_cast<std::uint64_t>(number));
}

// A number that is none of the three is passed over, like every property that we do not know.
std::optional<SparkplugQuality> QualityOf(const Payload::Metric& metric) {
  const Payload::PropertySet& set = metric.properties();
  for (int i = 0; i < std::min(set.keys_size(), set.values_size()); ++i) {
    if (set.keys(i) != kQuality) continue;
    for (const auto quality : {SparkplugQuality::kBad, SparkplugQuality::kGood, SparkplugQuality::kStale}) {
      if (set.values(i).int_value() == static_cast<std::uint32_t>(quality)) return quality;
    }
  }
  return std::nullopt;
}

std::optional<SparkplugMetric::Value> ValueOf(const Payload::Metric& metric) {
  switch (metric.datatype()) {
    case kDouble:
      if (metric.is_null() || metric.has_double_value()) return metric.double_value();
      return std::nullopt;
    case kInt64:
    case kUInt64:
      if (metric.is_null() || metric.has_long_value()) return static_cast<std::int64_t>(metric.long_value());
      return std::nullopt;
    case kBoolean:
      if (metric.is_null() || metric.has_boolean_value()) return metric.boolean_value();
      return std::nullopt;
    case kString:
      if (metric.is_null() || metric.has_string_value()) return metric.string_value();
      return std::nullopt;
    default:
      return std::nullopt;
  }
}

}  // namespace

SparkplugEdgeNode::SparkplugEdgeNode(std::string group, std::string node, int next_birth)
    : group_(std::move(group)), node_(std::move(node)), next_birth_(next_birth % kNumbers) {
  RequireTopicName("group", group_);
  RequireTopicName("node", node_);
}

std::string SparkplugEdgeNode::Topic(std::string_view type) const {
  return "spBv1.0/" + group_ + "/" + std::string(type) + "/" + node_;
}

std::string SparkplugEdgeNode::CommandTopic() const { return Topic("NCMD"); }

MqttMessage SparkplugEdgeNode::Death(std::int64_t now_ms) {
  birth_ = next_birth_;
  next_birth_ = (next_birth_ + 1) % kNumbers;
  next_sequence_ = -1;
  Payload payload;
  payload.set_timestamp(static_cast<std::uint64_t>(now_ms));
  AddBirthDeathNumber(payload, birth_);
  return {Topic("NDEATH"), payload.SerializeAsString(), 1, false};
}

MqttMessage SparkplugEdgeNode::Birth(std::int64_t now_ms, std::vector<SparkplugMetric> metrics) {
  if (birth_ < 0) throw std::logic_error("a birth before the death that the connection carries as its will");
  Payload payload;
  payload.set_timestamp(static_cast<std::uint64_t>(now_ms));
  payload.set_seq(0);
  AddBirthDeathNumber(payload, birth_);
  Add(payload, {.name = std::string(kRebirth), .value = false, .time_ms = now_ms});
  born_.clear();
  for (const SparkplugMetric& metric : metrics) {
    Add(payload, metric);
    born_.push_back(metric.name);
  }
  next_sequence_ = 1;
  return {Topic("NBIRTH"), payload.SerializeAsString(), 0, false};
}

MqttMessage SparkplugEdgeNode::Data(std::int64_t now_ms, const std::vector<SparkplugMetric>& metrics) {
  if (next_sequence_ < 0) throw std::logic_error("data before the birth of this connection");
  Payload payload;
  payload.set_timestamp(static_cast<std::uint64_t>(now_ms));
  for (const SparkplugMetric& metric : metrics) {
    if (std::find(born_.begin(), born_.end(), metric.name) == born_.end()) {
      throw std::invalid_argument("metric '" + metric.name + "' was not in the birth");
    }
    Add(payload, metric);
  }
  payload.set_seq(static_cast<std::uint64_t>(next_sequence_));
  next_sequence_ = (next_sequence_ + 1) % kNumbers;
  return {Topic("NDATA"), payload.SerializeAsString(), 0, false};
}

std::string HostStateTopic(const std::string& host) {
  RequireTopicName("host", host);
  return "spBv1.0/STATE/" + host;
}

std::string OldHostStateTopic(const std::string& host) {
  RequireTopicName("host", host);
  return "STATE/" + host;
}

std::optional<HostState> ParseHostState(std::string_view bytes) {
  if (bytes == "ONLINE" || bytes == "OFFLINE") return HostState{bytes == "ONLINE", std::nullopt};
  if (bytes.size() > kLongestWord_bytes) return std::nullopt;
  const auto json = nlohmann::json::parse(bytes, nullptr, false);
  if (!json.is_object() || !json.contains("online") || !json["online"].is_boolean() ||
      !json.contains("timestamp") || !json["timestamp"].is_number_integer()) {
    return std::nullopt;
  }
  return HostState{json["online"].get<bool>(), json["timestamp"].get<std::int64_t>()};
}

std::string EncodeMetrics(const std::vector<SparkplugMetric>& metrics) {
  Payload payload;
  for (const SparkplugMetric& metric : metrics) Add(payload, metric);
  return payload.SerializeAsString();
}

std::optional<SparkplugPayload> ParseSparkplug(std::string_view bytes) {
  Payload payload;
  if (!payload.ParseFromArray(bytes.data(), static_cast<int>(bytes.size()))) return std::nullopt;
  SparkplugPayload read{
      .time_ms = static_cast<std::int64_t>(payload.timestamp()), .sequence = {}, .metrics = {}};
  if (payload.has_seq()) read.sequence = static_cast<int>(payload.seq());
  for (const Payload::Metric& metric : payload.metrics()) {
    std::optional<SparkplugMetric::Value> value = ValueOf(metric);
    if (!value) return std::nullopt;
    read.metrics.push_back({.name = metric.name(),
                            .value = *std::move(value),
                            .time_ms = static_cast<std::int64_t>(metric.timestamp()),
                            .is_null = metric.is_null(),
                            .is_historical = metric.is_historical(),
                            .quality = QualityOf(metric)});
  }
  return read;
}

bool AsksForRebirth(std::string_view bytes) {
  Payload payload;
  if (bytes.size() > kLongestCommand_bytes) return false;
  if (!payload.ParseFromArray(bytes.data(), static_cast<int>(bytes.size()))) return false;
  return std::any_of(payload.metrics().begin(), payload.metrics().end(), [](const Payload::Metric& metric) {
    return metric.name() == kRebirth && metric.boolean_value();
  });
}

}  // namespace strainwave::protocols
