// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace strainwave::protocols {

/// The property "Quality" of a metric, with the specification's numbers (6.4.18).
enum class SparkplugQuality : int { kBad = 0, kGood = 192, kStale = 500 };

/// One named value of a Sparkplug payload. Nothing in the place of a value is a null of that type: the
/// quantity exists and is not known.
struct SparkplugMetric {
  using Value = std::variant<double, std::int64_t, bool, std::string>;

  std::string name;
  Value value;
  std::int64_t time_ms{};  // since 1970, UTC: when it was measured
  bool is_null{false};
  bool is_historical{false};  // stored while there was no connection
  std::optional<SparkplugQuality> quality{};
};

/// What goes to the broker.
struct MqttMessage {
  std::string topic;
  std::string payload;
  int qos{};
  bool retain{false};
};

/// The publishing side of one Sparkplug edge node: which message may come when, and what its numbers are.
///
/// A connection is: `Death` as the will of CONNECT, `Birth` first, then `Data`. Each new connection has the
/// next birth–death number (bdSeq, 0 to 255 and round), in will and birth alike, so that a late will is told
/// from a new one; each message after the birth has the next sequence number (0 to 255 and round).
///
/// Source: Eclipse Sparkplug specification 3.0.0, chapters 5.4 (topics), 6.4.5 to 6.4.8 (payloads).
class SparkplugEdgeNode {
 public:
  /// @param next_birth  the birth–death number of the first connection, 0 to 255.
  /// @throws std::invalid_argument if a name is empty or holds '/', '+' or '#'.
  SparkplugEdgeNode(std::string group, std::string node, int next_birth = 0);

  /// Begins a new connection: the will to register with it.
  MqttMessage Death(std::int64_t now_ms);
  /// All metrics that there will be, with the values of now. Must come first after the connection stands, and
  /// again when a host asks for it.
  /// @throws std::logic_error before the first `Death`.
  MqttMessage Birth(std::int64_t now_ms, std::vector<SparkplugMetric> metrics);
  /// Values that were measured since.
  /// @throws std::logic_error before `Birth` of this connection; std::invalid_argument for a metric that the
  ///   birth did not name.
  MqttMessage Data(std::int64_t now_ms, const std::vector<SparkplugMetric>& metrics);

  /// The birth–death number of the connection after this one, for whoever keeps it over a restart.
  int next_birth() const { return next_birth_; }

  /// Where commands to this node arrive.
  std::string CommandTopic() const;

 private:
  std::string Topic(std::string_view type) const;

  std::string group_;
  std::string node_;
  int next_birth_{0};
  int birth_{-1};
  int next_sequence_{-1};
  std::vector<std::string> born_;
};

/// Where the primary host, whom a node's data is meant for, says whether it listens; retained.
/// @throws std::invalid_argument as the edge node's names.
std::string HostStateTopic(const std::string& host);

/// Where hosts of Sparkplug 2.2 say it (chapter 13.1 of that version).
std::string OldHostStateTopic(const std::string& host);

/// The host's word under either topic.
struct HostState {
  bool online{};
  std::optional<std::int64_t> time_ms;  // nothing in 2.2
};

/// `{"online": …, "timestamp": …}` (5.5.1 and 6.4.24 of 3.0), or ONLINE and OFFLINE (2.2); nothing of
/// anything else.
std::optional<HostState> ParseHostState(std::string_view bytes);

/// A payload read back.
struct SparkplugPayload {
  std::int64_t time_ms{};
  std::optional<int> sequence;  // a death has none
  std::vector<SparkplugMetric> metrics;
};

/// Metrics alone as a payload, for whoever keeps them; `ParseSparkplug` reads them back.
std::string EncodeMetrics(const std::vector<SparkplugMetric>& metrics);

/// Nothing when the bytes are no payload, or a value is not of the type that it says.
std::optional<SparkplugPayload> ParseSparkplug(std::string_view bytes);

/// True for a command that asks the node for a new birth ("Node Control/Rebirth" = true).
bool AsksForRebirth(std::string_view bytes);

}  // namespace strainwave::protocols
