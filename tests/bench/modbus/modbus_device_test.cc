// SPDX-License-Identifier: Apache-2.0
// The device side, asked by pymodbus's client and by ours.
#include "bench/machines/device_side/modbus_device.h"

#include <gtest/gtest.h>

#include "bench/devices/modbus/modbus_address.h"
#include "bench/devices/modbus/modbus_link.h"
#include "bench/machines/listing/find_devices.h"
#include "tests/bench/modbus/modbus_helpers.h"

namespace strainwave::bench::modbus_device_test {
namespace {

using namespace std::chrono_literals;
using namespace protocols::modbus;
using Kind = ModbusDeviceFault::Kind;

Register Made(const char* name, int address, Table table, ValueType type, Access access) {
  Register value = Named(name, address);
  value.table = table;
  value.type = type;
  value.access = access;
  return value;
}

RegisterMap SomeMap() {
  RegisterMap map{"device",
                  {Made("float", 10, Table::kHolding, ValueType::kFloat32, Access::kReadWrite),
                   Made("small", 12, Table::kHolding, ValueType::kInt16, Access::kReadWrite),
                   Made("input", 3, Table::kInput, ValueType::kInt32, Access::kRead),
                   Made("coil", 5, Table::kCoil, ValueType::kBit, Access::kReadWrite),
                   Made("next", 6, Table::kCoil, ValueType::kBit, Access::kReadWrite),
                   Made("fixed", 20, Table::kHolding, ValueType::kUint16, Access::kRead)}};
  map.registers[1].most = 100;
  return map;
}

class Device : public testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    ModbusDevice::Behaviour behaviour{
        [this](std::size_t index) { return values_[index].load(); },
        [this](std::size_t index, double value) { return values_[index] = value, value != 13; }};
    if (is_tcp()) {
      device_ = std::make_unique<ModbusDevice>(SomeMap(), 1, behaviour, ModbusDevice::Tcp{});
      settings_.port = ModbusTcpPort{"127.0.0.1", device_->port()};
    } else {
      device_ = std::make_unique<ModbusDevice>(SomeMap(), 1, behaviour);
      settings_.port = ModbusSerialLine{device_->path(), 19'200, 'N'};
    }
    settings_.answer_time = 100ms;
    settings_.retries = 0;
  }
  bool is_tcp() const { return GetParam() == std::string("tcp"); }

  std::array<std::atomic<double>, 6> values_{-12.5, -3.0, -2.0, 1.0, 0.0, 7.0};
  std::unique_ptr<ModbusDevice> device_;
  ModbusSettings settings_;
};
INSTANTIATE_TEST_SUITE_P(Both, Device, testing::Values("tcp", "rtu"));

TEST_P(Device, AnswersPymodbus) {
  Peer peer("pymodbus_client.py", {GetParam(), is_tcp() ? std::to_string(device_->port()) : device_->path()});
  if (!peer.is_there()) GTEST_SKIP() << "skipped: " << peer.hello;
  const std::pair<const char*, const char*> both[] = {
      {"read holding 10 3", "49480 0 65533"},  // C148 0000: -12.5; -3
      {"read input 3 2", "65535 65534"},
      {"read coil 5 2", "1 0"},
      {"read holding 9 2", "exception 2"},  // nothing there
      {"read discrete 5 1", "exception 2"},
      {"read input 10 1", "exception 2"},
      {"write holding 12 42", "ok"},
      {"write holding 12 101", "exception 3"},  // above its most
      {"write holding 12 13", "exception 3"},   // the device does not like it
      {"write holding 20 1", "exception 2"},    // read-only
      {"write holding 10 1", "exception 2"},    // half a value
      {"write holding 10 16968 0 55", "ok"},    // 4248 0000: 50
      {"write coil 6 1", "ok"},
      {"write coil 5 0 1", "ok"},
      {"write coil 7 1", "exception 2"},
  };
  for (const auto& [line, answer] : both) EXPECT_EQ(peer.process.Say(line), answer) << line;
  EXPECT_EQ(values_[0], 50);
  EXPECT_EQ(values_[1], 55);
  EXPECT_EQ(values_[3], 0);
  EXPECT_EQ(values_[4], 1);
}

TEST_P(Device, IsFoundAmongUnits) {
  const std::string address =
      is_tcp() ? "tcp://127.0.0.1:" + std::to_string(device_->port()) : device_->path();
  FoundPart part{"modbus", {}, {}};
  FindOnModbus(settings_, 1, 3, address, part);
  ASSERT_EQ(part.devices.size(), 1U);
  EXPECT_EQ(part.devices[0].where, address + ", unit 1");
  EXPECT_EQ(part.devices[0].what,
            "answers; refuses holding register 0 (exception 2, illegal data address: the device has no such "
            "register)");
  EXPECT_TRUE(part.notes.empty());
  FoundPart none{"modbus", {}, {}};
  FindOnModbus(settings_, 2, 3, address, none);
  EXPECT_TRUE(none.devices.empty());
  ASSERT_EQ(none.notes.size(), 1U);
  EXPECT_EQ(
      none.notes[0],
      address +
          ": no unit from 2 to 3 answers within 100 ms (check unit, and on a line baud rate, parity and "
          "wiring)");
}

TEST(ModbusAddress, IsTakenAsPeopleWriteIt) {
  const auto tcp = std::get<ModbusTcpPort>(ParseModbusAddress("tcp://plc.lab:1502"));
  EXPECT_EQ(tcp.host, "plc.lab");
  EXPECT_EQ(tcp.port, 1502);
  const auto plain =
      std::get<ModbusSerialLine>(ParseModbusAddress("rtu:/dev/serial/by-path/pci-0000:00:14.0-usb-0:2:1.0"));
  EXPECT_EQ(plain.path, "/dev/serial/by-path/pci-0000:00:14.0-usb-0:2:1.0");
  EXPECT_EQ(plain.baud, 19'200);
  EXPECT_EQ(plain.parity, 'E');
  const auto line = std::get<ModbusSerialLine>(ParseModbusAddress("rtu:/dev/ttyUSB0:9600:8N2"));
  EXPECT_EQ(line.path, "/dev/ttyUSB0");
  EXPECT_EQ(line.baud, 9600);
  EXPECT_EQ(line.stop_bits, 2);
  for (const char* wrong :
       {"rtu:/dev/ttyUSB0:fast:8N2", "rtu:/dev/ttyUSB0:9600:7E1", "10.0.0.2:502", "rtu:ttyUSB0"}) {
    try {
      ParseModbusAddress(wrong);
      FAIL() << wrong;
    } catch (const std::invalid_argument& error) {
      EXPECT_EQ(error.what(),
                std::string("address = ") + wrong + " (expected tcp:HOST:PORT or rtu:PATH:BAUD:8E1)");
    }
  }
}

TEST_P(Device, DoesWrongWhatItIsToldTo) {
  std::uint16_t word = 0;
  const auto ask = [&] {
    ModbusLink link(settings_, nullptr);
    link.Open();
    return Words(link.Read({Table::kHolding, 20, 1, {}}, std::span(&word, 1)), settings_);
  };
  const auto with = [&](Kind kind) {
    device_->Set({kind, 1, 6, 1h});
    return ask();
  };
  EXPECT_EQ(ask(), "good");
  EXPECT_EQ(with(Kind::kSilence), "no answer within 100 ms, asked 1 times");
  EXPECT_EQ(with(Kind::kException), "refused with exception 6, device busy: ask again later");
  EXPECT_EQ(with(Kind::kOtherUnit), "wrong answer: it is from another unit");
  EXPECT_EQ(with(Kind::kHalf),
            is_tcp() ? "wrong answer: half of it came" : "no answer within 100 ms, asked 1 times");
  EXPECT_EQ(with(Kind::kOtherTransaction),
            is_tcp() ? "wrong answer: its transaction number is that of no request" : "good");
  EXPECT_EQ(ask(), "good") << "once, and no more";
  EXPECT_EQ(word, 7);
  EXPECT_EQ(with(Kind::kDelay), "no answer within 100 ms, asked 1 times");
}

TEST_P(Device, ThatIsUnpluggedOrRefusesDoesNothing) {
  const auto write = [&](Kind kind) {
    device_->Set({kind, -1, 6});
    ModbusLink link(settings_, nullptr);
    link.Open();
    return Words(link.Write({Table::kHolding, 12, {42}}), settings_);
  };
  EXPECT_EQ(write(Kind::kUnplugged), "no answer within 100 ms, asked 1 times");
  EXPECT_EQ(write(Kind::kException), "refused with exception 6, device busy: ask again later");
  EXPECT_EQ(values_[1], -3.0);
  EXPECT_EQ(write(Kind::kSilence), "no answer within 100 ms, asked 1 times");
  EXPECT_EQ(values_[1], 42.0) << "heard, and not answered";
}

TEST_P(Device, ResetsItsConnections) {
  if (!is_tcp()) GTEST_SKIP() << "skipped: a line has no connection";
  std::uint16_t word = 0;
  const ReadRequest request{Table::kHolding, 20, 1, {}};
  ModbusLink link(settings_, nullptr);
  link.Open();
  ASSERT_TRUE(link.Read(request, std::span(&word, 1)).good());
  device_->ResetConnections();
  EXPECT_TRUE(Until([&] {
    return link.Read(request, std::span(&word, 1)).outcome == ModbusReply::Outcome::kDisconnected;
  }));
  link.Open();
  EXPECT_TRUE(link.Read(request, std::span(&word, 1)).good());
}

TEST_P(Device, DriftsOnCommand) {
  ModbusLink link(settings_, nullptr);
  link.Open();
  device_->Drift(5, 1000.0);
  std::uint16_t word = 7;
  EXPECT_TRUE(Until([&] {
    return link.Read({Table::kHolding, 20, 1, {}}, std::span(&word, 1)).good() && word > 20;
  }));
  device_->Drift(5, 0.0);
  ASSERT_TRUE(link.Read({Table::kHolding, 20, 1, {}}, std::span(&word, 1)).good());
  EXPECT_EQ(word, 7);
}

TEST_P(Device, OfAnotherUnitIsToldSo) {
  if (!is_tcp()) GTEST_SKIP() << "skipped: on a line, nobody answers for another unit";
  settings_.unit = 9;
  ModbusLink link(settings_, nullptr);
  link.Open();
  std::uint16_t word = 0;
  EXPECT_EQ(Words(link.Read({Table::kHolding, 20, 1, {}}, std::span(&word, 1)), settings_),
            "refused with exception 11, no answer from the device behind the gateway");
}

}  // namespace
}  // namespace strainwave::bench::modbus_device_test
