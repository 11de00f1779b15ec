// SPDX-License-Identifier: Apache-2.0
#include "bench/devices/modbus/modbus_poller.h"

#include <gtest/gtest.h>

#include <array>
#include <atomic>

#include "bench/machines/device_side/modbus_device.h"
#include "tests/bench/modbus/modbus_helpers.h"
#include "tests/bench/test_clock.h"

namespace strainwave::bench::modbus_poller_test {
namespace {

using namespace std::chrono_literals;

TEST(ModbusPoller, AsksForEachRegisterAtItsOwnRate) {
  protocols::modbus::RegisterMap map{"device", {Named("fast", 10), Named("slow", 20), Named("never", 30)}};
  map.registers[0].poll_period = 10ms;
  map.registers[1].poll_period = 50ms;
  std::array<std::atomic<int>, 3> readings{};
  std::atomic<int> requests = 0;
  ModbusDevice device(map, 1,
                      {[&](std::size_t index) { return static_cast<double>(++readings[index]); },
                       [](std::size_t, double) { return false; }, [&] { ++requests; }},
                      ModbusDevice::Tcp{});
  ModbusSettings settings;
  settings.port = ModbusTcpPort{"127.0.0.1", device.port()};
  ModbusLink link(settings, nullptr);
  link.Open();
  TestClock clock;
  ModbusPoller poller(map, clock);
  for (; clock.now < 200ms; clock.now += 1ms) {
    while (poller.NextDue() <= clock.now) ASSERT_TRUE(poller.PollOne(link).good());
  }
  EXPECT_EQ(readings[0], 20);
  EXPECT_EQ(readings[1], 4);
  EXPECT_EQ(readings[2], 0);
  EXPECT_EQ(requests, 24) << "the two lie too far apart for one request";
  EXPECT_EQ(poller.Value(0).time, 190ms);
  EXPECT_EQ(poller.Value(1).time, 150ms);
}

}  // namespace
}  // namespace strainwave::bench::modbus_poller_test
