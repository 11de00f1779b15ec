// SPDX-License-Identifier: Apache-2.0
// A device that misbehaves (peers/faulty_server.py), over TCP and RTU: its register at address A holds
// 1000 + A, so that a value in the wrong place is seen.
#include <gtest/gtest.h>

#include "bench/devices/modbus/modbus_client.h"
#include "bench/devices/modbus/modbus_link.h"
#include "tests/bench/modbus/modbus_helpers.h"

namespace strainwave::bench::modbus_faults_test {
namespace {

using namespace std::chrono_literals;
using Outcome = ModbusReply::Outcome;
using protocols::modbus::ReadPdu;
using protocols::modbus::Table;

class Faults : public testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    if (!peer_.is_there()) GTEST_SKIP() << "skipped: " << peer_.hello;
    settings_ = peer_.Settings();
    settings_.answer_time = 100ms;
    transport_ = MakeTransport(settings_, counts_);
    transport_->Open();
  }

  void Mode(const std::string& mode) { ASSERT_EQ(peer_.process.Say(mode), "ok"); }
  bool is_tcp() const { return GetParam() == std::string("tcp"); }

  // One register, asked once.
  ModbusReply Ask(std::uint16_t address) {
    word_ = 0;
    return transport_->Ask(ReadPdu(Table::kHolding, address, 1), std::span(&word_, 1), nullptr);
  }
  void ExpectRight(std::uint16_t address) {
    ASSERT_EQ(Words(Ask(address), settings_), "good");
    EXPECT_EQ(word_, 1000 + address);
  }

  Peer peer_{"faulty_server.py", {GetParam()}};
  ModbusSettings settings_;
  ModbusCounts counts_;
  std::unique_ptr<ModbusTransport> transport_;
  std::uint16_t word_{};
};
INSTANTIATE_TEST_SUITE_P(Both, Faults, testing::Values("tcp", "rtu"));

TEST_P(Faults, ALateAnswerIsNotTakenForTheNext) {
  ExpectRight(10);
  Mode("late");
  EXPECT_EQ(Ask(10).outcome, Outcome::kTimeout);
  ExpectRight(20);  // the answer to 10 comes first
  EXPECT_EQ(counts_.late_answers, 1U);
  ExpectRight(30);
}

TEST_P(Faults, ADeviceThatAlwaysAnswersOneLateGivesNoWrongValue) {
  Mode("shift");
  int good = 0;
  for (std::uint16_t i = 0; i < 12; ++i) {
    if (!Ask(i).good()) continue;
    ++good;
    EXPECT_EQ(word_, 1000 + i);
  }
  EXPECT_EQ(good, 0);
  Mode("good");
  for (std::uint16_t i = 0; i < 3 && !Ask(50).good(); ++i) continue;
  ExpectRight(60);
}

TEST_P(Faults, OfALinkThatConnectsAgainAndAgainStillGiveNoWrongValue) {
  transport_.reset();
  settings_.retries = 1;
  ModbusLink link(settings_, nullptr);
  Mode("shift");
  for (std::uint16_t i = 0; i < 4; ++i) {
    if (!link.is_open()) link.Open();
    const auto reply = link.Read({Table::kHolding, i, 1, {}}, std::span(&word_, 1));
    EXPECT_TRUE(!reply.good() || word_ == 1000 + i);
  }
  Mode("good");
  if (!link.is_open()) link.Open();
  for (int i = 0; i < 3; ++i) link.Read({Table::kHolding, 40, 1, {}}, std::span(&word_, 1));
  if (!link.is_open()) link.Open();
  ASSERT_TRUE(link.Read({Table::kHolding, 40, 1, {}}, std::span(&word_, 1)).good());
  EXPECT_EQ(word_, 1040);
}

TEST_P(Faults, WrongAnswersAreToldInWordsAndTheNextIsRight) {
  const std::pair<std::string, std::string> both[] = {
      {"unit 2", "wrong answer: it is from another unit"},
      {"unit 0", "wrong answer: it is from another unit"},
      {"function", "wrong answer: it is to another function"},
      {"longer", "wrong answer: its length is not that which was asked for"},
      {"exception 2", "refused with exception 2, illegal data address: the device has no such register"},
      {"silent", "no answer within 100 ms, asked 3 times"},
  };
  for (const auto& [mode, words] : both) {
    Mode(mode);
    EXPECT_EQ(Words(Ask(10), settings_), words) << mode;
    Mode("good");
    if (!transport_->is_open()) transport_->Open();
    ExpectRight(20);
  }
}

TEST_P(Faults, WhatOnlyOneTransportKnowsIsToldInWords) {
  using List = std::vector<std::pair<std::string, std::string>>;
  const List tcp = {{"number", "wrong answer: its transaction number is that of no request"},
                    {"envelope", "wrong answer: its envelope is not one of Modbus TCP"},
                    {"half", "wrong answer: half of it came"}};
  const List rtu = {{"checksum", "wrong answer: its checksum is wrong"},
                    {"half", "no answer within 100 ms, asked 3 times"}};
  for (const auto& [mode, words] : is_tcp() ? tcp : rtu) {
    Mode(mode);
    EXPECT_EQ(Words(Ask(10), settings_), words) << mode;
    Mode("good");
    if (!transport_->is_open()) transport_->Open();
    ExpectRight(20);
  }
}

TEST_P(Faults, AWriteIsBelievedOnlyByItsEcho) {
  const std::uint16_t words[] = {5, 6};
  const auto one = protocols::modbus::WritePdu(Table::kHolding, 7, std::span(words).first(1));
  const auto two = protocols::modbus::WritePdu(Table::kHolding, 7, words);
  EXPECT_TRUE(transport_->Ask(one, {}, nullptr).good());
  EXPECT_TRUE(transport_->Ask(two, {}, nullptr).good());
  Mode("address");
  EXPECT_EQ(Words(transport_->Ask(two, {}, nullptr), settings_),
            "wrong answer: it confirms another address or value than was written");
}

TEST_P(Faults, ALinkAsksAgainAndThenGivesTheConnectionUp) {
  transport_.reset();
  settings_.retries = 2;
  ModbusLink link(settings_, nullptr);
  link.Open();
  Mode("silent");
  EXPECT_EQ(link.Read({Table::kHolding, 0, 1, {}}, std::span(&word_, 1)).outcome, Outcome::kTimeout);
  EXPECT_EQ(link.counts().timeouts, 3U);
  EXPECT_FALSE(link.is_open());
  EXPECT_EQ(link.Read({Table::kHolding, 0, 1, {}}, std::span(&word_, 1)).outcome, Outcome::kDisconnected);
  Mode("good");
  link.Open();
  EXPECT_TRUE(link.Read({Table::kHolding, 0, 1, {}}, std::span(&word_, 1)).good());
}

TEST_P(Faults, ACallEndsTheWaitingForAReadingOverTcp) {
  if (!is_tcp()) GTEST_SKIP() << "skipped: RTU finishes the answer that it waits for";
  settings_.answer_time = 1h;
  Mode("silent");
  Wake wake;
  wake.Call();
  EXPECT_EQ(transport_->Ask(ReadPdu(Table::kHolding, 0, 1), std::span(&word_, 1), &wake).outcome,
            Outcome::kInterrupted);
}

TEST_P(Faults, AClientsValuesGrowStaleAndComeBack) {
  transport_.reset();
  protocols::modbus::RegisterMap map{"peer", {Named("a", 0), Named("b", 9)}};
  for (auto& value : map.registers) value.poll_period = 10ms;
  SteadyBenchClock clock;
  settings_.retries = 0;
  ModbusClient client(settings_, map, clock);
  const auto all_good = [&] { return client.Value(0).good && client.Value(1).good; };
  ASSERT_TRUE(Until(all_good));
  EXPECT_TRUE(client.connected());
  EXPECT_EQ(client.trouble(), "");
  Mode("silent");
  ASSERT_TRUE(Until([&] { return !client.Value(0).good && !client.Value(1).good; }));
  EXPECT_TRUE(Until([&] { return client.trouble().find("no answer within 100 ms") != std::string::npos; }));
  Mode("shift");
  for (int i = 0; i < 200; ++i) {
    const ChannelValue a = client.Value(0), b = client.Value(1);
    EXPECT_TRUE(!a.good || a.value == 1000);
    EXPECT_TRUE(!b.good || b.value == 1009);
    std::this_thread::sleep_for(1ms);
  }
  Mode("good");
  ASSERT_TRUE(Until(all_good));
  EXPECT_EQ(client.Value(0).value, 1000);
  EXPECT_EQ(client.Value(1).value, 1009);
  EXPECT_TRUE(Until([&] { return client.trouble().empty(); }));
}

TEST_P(Faults, ARefusedRegisterIsNoValueAndNamedAndTheOthersGoOn) {
  transport_.reset();
  protocols::modbus::RegisterMap map{"peer", {Named("a", 0)}};
  map.registers[0].poll_period = 5ms;
  SteadyBenchClock clock;
  ModbusClient client(settings_, map, clock);
  ASSERT_TRUE(Until([&] { return client.Value(0).good; }));
  Mode("exception 4");
  ASSERT_TRUE(Until([&] { return !client.trouble().empty(); }));
  EXPECT_FALSE(client.Value(0).good);
  EXPECT_TRUE(client.connected());
  EXPECT_EQ(client.trouble(),
            "reading holding 0 to 0 (a): refused with exception 4, device failure: it could not do what was "
            "asked");
}

TEST_P(Faults, AnUnsoundMapIsRefused) {
  protocols::modbus::RegisterMap map{"amplifier", {Named("a", 0), Named("b", 0)}};
  SteadyBenchClock clock;
  try {
    ModbusClient client(settings_, map, clock);
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_STREQ(error.what(),
                 "map of amplifier: 'b' at 0 lies over 'a' at 0 of the holding table (expected each address "
                 "once)");
  }
}

}  // namespace
}  // namespace strainwave::bench::modbus_faults_test
