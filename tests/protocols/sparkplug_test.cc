// SPDX-License-Identifier: Apache-2.0
#include "protocols/sparkplug.h"

#include <gtest/gtest.h>

#include <stdexcept>
#include <string>

namespace strainwave::protocols::sparkplug_test {
namespace {

using namespace std::string_literals;

SparkplugMetric Temperature(double value) { return {.name = "t", .value = value, .time_ms = 1}; }

SparkplugPayload Parsed(const MqttMessage& message) {
  const auto payload = ParseSparkplug(message.payload);
  EXPECT_TRUE(payload.has_value());
  return payload.value_or(SparkplugPayload{});
}

std::int64_t BirthDeathNumber(const MqttMessage& message) {
  const SparkplugPayload payload = Parsed(message);
  EXPECT_EQ(payload.metrics.at(0).name, "bdSeq");
  return std::get<std::int64_t>(payload.metrics.at(0).value);
}

// By hand from the wire format of protocol buffers and the field numbers of the specification: field 1
// varint, field 2 with length, inside it name (1), time (3), data type 10 (4) and 2.0 as eight bytes (13),
// field 3.
TEST(SparkplugEdgeNode, WritesTheBytesThatTheSpecificationAsksFor) {
  SparkplugEdgeNode node("lab", "bench1");
  node.Death(0);
  node.Birth(0, {Temperature(0.0)});
  const MqttMessage data = node.Data(7, {Temperature(2.0)});
  EXPECT_EQ(data.topic, "spBv1.0/lab/NDATA/bench1");
  EXPECT_EQ(data.payload,
            "\x08\x07\x12\x10\x0a\x01t\x18\x01\x20\x0a\x69\x00\x00\x00\x00\x00\x00\x00\x40\x18\x01"s);
  EXPECT_EQ(data.qos, 0);
  EXPECT_FALSE(data.retain);
}

TEST(SparkplugEdgeNode, DeathIsAWillOfQosOneWithoutASequenceNumber) {
  SparkplugEdgeNode node("lab", "bench1");
  const MqttMessage death = node.Death(5);
  EXPECT_EQ(death.topic, "spBv1.0/lab/NDEATH/bench1");
  EXPECT_EQ(death.qos, 1);
  EXPECT_FALSE(death.retain);
  EXPECT_FALSE(Parsed(death).sequence.has_value());
}

TEST(SparkplugEdgeNode, BirthAndDeathOfOneConnectionShareTheirNumber) {
  SparkplugEdgeNode node("lab", "bench1");
  for (int connection = 0; connection < 600; ++connection) {
    EXPECT_EQ(BirthDeathNumber(node.Death(0)), connection % 256);
    EXPECT_EQ(BirthDeathNumber(node.Birth(0, {})), connection % 256);
  }
}

TEST(SparkplugEdgeNode, SequenceBeginsWithTheBirthAndRunsRoundAt256) {
  SparkplugEdgeNode node("lab", "bench1");
  node.Death(0);
  EXPECT_EQ(Parsed(node.Birth(0, {Temperature(0.0)})).sequence, 0);
  for (int k = 1; k < 600; ++k) EXPECT_EQ(Parsed(node.Data(0, {Temperature(0.0)})).sequence, k % 256);
  EXPECT_EQ(Parsed(node.Birth(0, {Temperature(0.0)})).sequence, 0);  // a host has asked for it
  EXPECT_EQ(Parsed(node.Data(0, {Temperature(0.0)})).sequence, 1);
}

TEST(SparkplugEdgeNode, LetsNoDataOutBeforeTheBirthOfItsConnection) {
  SparkplugEdgeNode node("lab", "bench1");
  EXPECT_THROW(node.Birth(0, {}), std::logic_error);
  node.Death(0);
  EXPECT_THROW(node.Data(0, {}), std::logic_error);
  node.Birth(0, {Temperature(0.0)});
  node.Data(0, {Temperature(0.0)});
  EXPECT_THROW(node.Data(0, {{.name = "other", .value = 1.0}}), std::invalid_argument);
  node.Death(0);
  EXPECT_THROW(node.Data(0, {Temperature(0.0)}), std::logic_error);
}

TEST(SparkplugEdgeNode, RefusesNamesThatWouldBeOtherTopics) {
  EXPECT_THROW(SparkplugEdgeNode("a/b", "c"), std::invalid_argument);
  EXPECT_THROW(SparkplugEdgeNode("a", ""), std::invalid_argument);
  EXPECT_THROW(SparkplugEdgeNode("a", "#"), std::invalid_argument);
}

TEST(ParseSparkplug, GivesBackAllTypesAndMarks) {
  SparkplugEdgeNode node("lab", "bench1");
  node.Death(0);
  const auto read = Parsed(node.Birth(9, {{.name = "d", .value = -0.5, .time_ms = 3},
                                          {.name = "i", .value = std::int64_t{-7}, .is_historical = true},
                                          {.name = "b", .value = true},
                                          {.name = "s", .value = "warning"s},
                                          {.name = "n", .value = 0.0, .is_null = true}}));
  EXPECT_EQ(read.time_ms, 9);
  ASSERT_EQ(read.metrics.size(), 7U);  // bdSeq and the rebirth control stand in front
  EXPECT_EQ(read.metrics[1].name, "Node Control/Rebirth");
  EXPECT_EQ(std::get<double>(read.metrics[2].value), -0.5);
  EXPECT_EQ(read.metrics[2].time_ms, 3);
  EXPECT_EQ(std::get<std::int64_t>(read.metrics[3].value), -7);
  EXPECT_TRUE(read.metrics[3].is_historical);
  EXPECT_TRUE(std::get<bool>(read.metrics[4].value));
  EXPECT_EQ(std::get<std::string>(read.metrics[5].value), "warning");
  EXPECT_TRUE(read.metrics[6].is_null);
}

TEST(ParseSparkplug, RefusesEveryPieceOfAPayloadThatIsNotOne) {
  SparkplugEdgeNode node("lab", "bench1");
  const std::string whole = node.Death(1'700'000'000'000).payload;
  for (std::size_t length = 8; length < whole.size(); ++length) {
    EXPECT_FALSE(ParseSparkplug(whole.substr(0, length)).has_value()) << length;
  }
  EXPECT_FALSE(ParseSparkplug("\xff\xff\xff").has_value());
}

TEST(HostState, IsReadInBothVersions) {
  EXPECT_EQ(HostStateTopic("scada"), "spBv1.0/STATE/scada");
  EXPECT_EQ(OldHostStateTopic("scada"), "STATE/scada");
  const auto newer = ParseHostState(R"({"online": false, "timestamp": 1700000000000})");
  ASSERT_TRUE(newer.has_value());
  EXPECT_FALSE(newer->online);
  EXPECT_EQ(newer->time_ms, 1'700'000'000'000);
  const auto older = ParseHostState("ONLINE");
  ASSERT_TRUE(older.has_value());
  EXPECT_TRUE(older->online);
  EXPECT_EQ(older->time_ms, std::nullopt);
  EXPECT_FALSE(ParseHostState("OFFLINE")->online);
  for (const char* other :
       {"", "online", "ONLINE ", "true", "{}", R"({"online": true})", R"({"online": 1, "timestamp": 2})"}) {
    EXPECT_FALSE(ParseHostState(other).has_value()) << other;
  }
}

// A broker passes on 256 MB.
TEST(HostState, IsNoneThatIsTooLong) {
  const std::string word = R"({"online": true, "timestamp": 1})";
  EXPECT_TRUE(ParseHostState(word + std::string(4096 - word.size(), ' ')).has_value());
  EXPECT_FALSE(ParseHostState(word + std::string(4097 - word.size(), ' ')).has_value());
}

TEST(AsksForRebirth, OnlyWhenTheControlIsTrue) {
  const std::string name = "\x0a\x14Node Control/Rebirth"s;
  EXPECT_TRUE(AsksForRebirth("\x12\x1a"s + name + "\x20\x0b\x70\x01"s));
  EXPECT_FALSE(AsksForRebirth("\x12\x1a"s + name + "\x20\x0b\x70\x00"s));
  EXPECT_FALSE(AsksForRebirth("nonsense"));
  std::string long_one;
  while (long_one.size() <= std::size_t{1} << 20U) long_one += "\x12\x1a"s + name + "\x20\x0b\x70\x01"s;
  EXPECT_FALSE(AsksForRebirth(long_one));
}

}  // namespace
}  // namespace strainwave::protocols::sparkplug_test
