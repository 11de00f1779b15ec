// SPDX-License-Identifier: Apache-2.0
// Against pymodbus's server, over TCP and over RTU through a pair of pseudo terminals of socat.
#include <gtest/gtest.h>

#include <filesystem>

#include "bench/devices/modbus/modbus_client.h"
#include "protocols/modbus/register_codec.h"
#include "tests/bench/modbus/modbus_helpers.h"

namespace strainwave::bench::modbus_pymodbus_test {
namespace {

using namespace std::chrono_literals;
using namespace protocols::modbus;

// Two ends of a line, as long as it lives.
struct SocatLine {
  SocatLine() {
    const auto folder = std::filesystem::path(testing::TempDir());
    const std::string name = "strainwave-line-" + std::to_string(::getpid());
    ours = folder / (name + "-ours");
    theirs = folder / (name + "-theirs");
    const auto end = [](const std::string& path) { return "pty,raw,echo=0,link=" + path; };
    process = std::make_unique<PeerProcess>(std::vector<std::string>{"socat", end(ours), end(theirs)});
    made = Until([&] { return process->ended() || (IsThere(ours) && IsThere(theirs)); }) && !process->ended();
  }
  static bool IsThere(const std::string& path) { return std::filesystem::exists(path); }

  std::string ours, theirs;
  std::unique_ptr<PeerProcess> process;
  bool made{};
};

class Pymodbus : public testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    std::vector<std::string> arguments{GetParam()};
    if (is_rtu()) {
      line_ = std::make_unique<SocatLine>();
      if (!line_->made) GTEST_SKIP() << "skipped: there is no socat";
      arguments.push_back(line_->theirs);
    }
    peer_ = std::make_unique<Peer>("pymodbus_server.py", arguments);
    if (!peer_->is_there()) GTEST_SKIP() << "skipped: " << peer_->hello;
    settings_ = peer_->Settings();
    if (is_rtu()) settings_.port = ModbusSerialLine{line_->ours, 19'200, 'N'};
    settings_.answer_time = 2s;  // the machine may have more to do than to answer
  }
  bool is_rtu() const { return GetParam() == std::string("rtu"); }

  std::unique_ptr<SocatLine> line_;
  std::unique_ptr<Peer> peer_;
  ModbusSettings settings_;
};
INSTANTIATE_TEST_SUITE_P(Both, Pymodbus, testing::Values("tcp", "rtu"));

// A register as the peer's lines name it, and a value that shows every byte.
struct Case {
  Register value;
  std::string words;  // "holding 10 float32 low high"
  std::string number;
};

std::vector<Case> AllCases(Table table) {
  const std::tuple<ValueType, const char*, const char*> numbers[] = {
      {ValueType::kInt16, "int16", "-12345"},
      {ValueType::kUint16, "uint16", "54321"},
      {ValueType::kInt32, "int32", "-1234567890"},
      {ValueType::kUint32, "uint32", "3456789012"},
      {ValueType::kFloat32, "float32", "-123.45600128173828"}};
  const char* const name = table == Table::kHolding ? "holding" : "input";
  std::vector<Case> cases;
  int address = 10;
  for (const auto& [type, type_name, number] : numbers) {
    for (const WordOrder words : {WordOrder::kHighFirst, WordOrder::kLowFirst}) {
      for (const ByteOrder bytes : {ByteOrder::kHighFirst, ByteOrder::kLowFirst}) {
        Case one{Named("", address), {}, number};
        const auto word = [](bool high) { return high ? " high" : " low"; };
        one.words = std::string(name) + " " + std::to_string(address) + " " + type_name +
                    word(words == WordOrder::kHighFirst) + word(bytes == ByteOrder::kHighFirst);
        one.value.name = one.words;
        one.value.table = table;
        one.value.type = type;
        one.value.word_order = words;
        one.value.byte_order = bytes;
        one.value.poll_period = 10ms;
        one.value.good_for = 60s;
        if (table == Table::kHolding) one.value.access = Access::kReadWrite;
        cases.push_back(one);
        address += Length(type);
      }
    }
  }
  return cases;
}

TEST_P(Pymodbus, GivesAClientEveryTypeInEveryOrderFromEveryTable) {
  RegisterMap map;
  std::vector<std::string> numbers;
  for (const Table table : {Table::kHolding, Table::kInput}) {
    for (const Case& one : AllCases(table)) {
      ASSERT_EQ(peer_->process.Say("set " + one.words + " " + one.number), "ok");
      map.registers.push_back(one.value);
      numbers.push_back(one.number);
    }
  }
  for (const Table table : {Table::kCoil, Table::kDiscrete}) {
    for (int address = 0; address < 11; ++address) {
      Register bit = Named("", address);
      bit.name = (table == Table::kCoil ? "coil " : "discrete ") + std::to_string(address) + " bit - -";
      bit.table = table;
      bit.type = ValueType::kBit;
      bit.poll_period = 10ms;
      bit.good_for = 60s;
      numbers.push_back(address % 3 == 0 ? "1" : "0");
      ASSERT_EQ(peer_->process.Say("set " + bit.name + " " + numbers.back()), "ok");
      map.registers.push_back(bit);
    }
  }
  SteadyBenchClock clock;
  ModbusClient client(settings_, map, clock);
  for (std::size_t i = 0; i < map.registers.size(); ++i) {
    ASSERT_TRUE(Until([&] { return client.Value(i).good; })) << client.trouble();
    EXPECT_EQ(client.Value(i).value, std::stod(numbers[i])) << map.registers[i].name;
  }
}

TEST_P(Pymodbus, TakesEveryTypeInEveryOrder) {
  RegisterMap map;
  std::vector<std::pair<std::size_t, double>> values;
  const std::vector<Case> cases = AllCases(Table::kHolding);
  for (const Case& one : cases) {
    values.emplace_back(map.registers.size(), std::stod(one.number));
    map.registers.push_back(one.value);
  }
  ModbusLink link(settings_, nullptr);
  link.Open();
  const auto plan = PlanWrites(map, values);
  EXPECT_EQ(plan.size(), 1U);
  const ModbusReply reply = link.Write(plan);
  ASSERT_TRUE(reply.good()) << Words(reply, settings_);
  for (const Case& one : cases) {
    EXPECT_EQ(std::stod(peer_->process.Say("get " + one.words)), std::stod(one.number)) << one.words;
  }
  EXPECT_TRUE(link.Write({Table::kCoil, 3, {1}}).good());
  EXPECT_TRUE(link.Write({Table::kCoil, 5, {1, 0, 1}}).good());
  EXPECT_EQ(peer_->process.Say("get coil 3 bit"), "1");
  EXPECT_EQ(peer_->process.Say("get coil 5 bit"), "1");
  EXPECT_EQ(peer_->process.Say("get coil 6 bit"), "0");
  EXPECT_EQ(peer_->process.Say("get coil 7 bit"), "1");
}

TEST_P(Pymodbus, RefusesAnAddressThatItDoesNotHave) {
  ModbusLink link(settings_, nullptr);
  link.Open();
  std::uint16_t word = 0;
  const ModbusReply reply = link.Read({Table::kHolding, 5000, 1, {}}, std::span(&word, 1));
  EXPECT_EQ(Words(reply, settings_),
            "refused with exception 2, illegal data address: the device has no such register");
  EXPECT_TRUE(link.Read({Table::kHolding, 0, 1, {}}, std::span(&word, 1)).good());
}

TEST_P(Pymodbus, ThatEndsLeavesNoValueButAReason) {
  if (is_rtu()) GTEST_SKIP() << "skipped: the line of a serial device does not end with it";
  RegisterMap map{{}, {Named("a", 0)}};
  map.registers[0].poll_period = 10ms;
  map.registers[0].good_for = 100ms;
  SteadyBenchClock clock;
  settings_.answer_time = 200ms;
  settings_.longest_pause = 50ms;
  ModbusClient client(settings_, map, clock);
  ASSERT_TRUE(Until([&] { return client.Value(0).good; }));
  peer_->process.End();
  ASSERT_TRUE(Until([&] { return !client.Value(0).good && !client.connected(); }));
  EXPECT_TRUE(Until([&] { return client.trouble().find("Connection refused") != std::string::npos; }))
      << client.trouble();
  EXPECT_EQ(client.counts().connections, 1U);
}

}  // namespace
}  // namespace strainwave::bench::modbus_pymodbus_test
