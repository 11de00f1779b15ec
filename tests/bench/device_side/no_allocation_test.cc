// SPDX-License-Identifier: Apache-2.0
// In the cycle nothing takes memory: neither the drive nor the in-process bus.
#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>
#include <new>

#include "bench/devices/can/in_process_can_bus.h"
#include "bench/machines/device_side/drive_on_bus.h"
#include "tests/protocols/canopen/drive_node_fixture.h"

namespace {
std::atomic<long> taken{};
}  // namespace

void* operator new(std::size_t size) {
  ++taken;
  if (void* memory = std::malloc(size)) return memory;
  throw std::bad_alloc();
}
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }

namespace strainwave::bench::no_allocation_test {
namespace {

using protocols::canopen::device::ByHand;
using protocols::canopen::device::DriveEds;
using protocols::canopen::device::DriveNode;
using protocols::canopen::device::ObedientMotor;

TEST(DriveOnBus, TakesNoMemoryInTheCycle) {
  InProcessCanBus bus({});
  ObedientMotor motor;
  DriveNode node(DriveEds(), 1, motor);
  DriveOnBus drive(bus.end(1), node);
  std::chrono::nanoseconds now{};
  const auto cycle = [&](int cycles) {
    ReceivedFrame received;
    for (int i = 0; i < cycles; ++i) {
      now += std::chrono::milliseconds(1);
      bus.Exchange(now);
      drive.Cycle(now);
      motor.Step(0.001);
      while (bus.end(0).Receive(received)) continue;
    }
  };
  const auto give = [&](const char* text) {
    bus.end(0).Send(ByHand(text));
    cycle(3);
  };
  cycle(1);
  for (const char* frame :
       {"601#2B 17 10 00 0A 00 00 00", "601#23 16 10 01 64 00 10 00", "601#2F 01 18 02 01 00 00 00",
        "601#23 01 18 01 81 02 00 40", "601#2F 60 60 00 03 00 00 00", "000#01 01", "201#06 00", "201#07 00",
        "201#0F 00", "601#23 FF 60 00 00 00 05 00", "710#05"}) {
    give(frame);
  }
  ASSERT_EQ(node.power_state(), protocols::PowerState::kOperationEnabled);
  const protocols::CanFrame sync = ByHand("080#");
  const protocols::CanFrame controlword = ByHand("201#0F 00");
  const protocols::CanFrame heartbeat = ByHand("710#05");
  const long before = taken;
  for (int i = 0; i < 500; ++i) {
    bus.end(0).Send(sync);
    bus.end(0).Send(controlword);
    if (i % 20 == 0) bus.end(0).Send(heartbeat);
    cycle(1);
  }
  cycle(200);  // the heartbeat stays away: emergency, fault reaction, fault
  EXPECT_EQ(taken - before, 0);
  EXPECT_EQ(node.power_state(), protocols::PowerState::kFault);
  EXPECT_GT(drive.sent(), 500U + 50U);  // TPDOs and heartbeats
}

}  // namespace
}  // namespace strainwave::bench::no_allocation_test
