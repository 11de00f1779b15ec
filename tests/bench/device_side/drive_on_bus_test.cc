// SPDX-License-Identifier: Apache-2.0
// Our own drive on the in-process bus, moving the simulated bench; its master is written by hand.
#include "bench/machines/device_side/drive_on_bus.h"

#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <numbers>
#include <string>

#include "bench/devices/can/in_process_can_bus.h"
#include "bench/devices/simulated/simulated_bench.h"
#include "bench/machines/device_side/servo_physics.h"
#include "tests/protocols/canopen/drive_node_fixture.h"

namespace strainwave::bench::drive_on_bus_test {
namespace {

using protocols::PowerState;
using protocols::canopen::device::ByEye;
using protocols::canopen::device::ByHand;
using protocols::canopen::device::DriveEds;
using protocols::canopen::device::DriveNode;

constexpr double kTurn_rad = 2 * std::numbers::pi;

class DriveOnBusTest : public testing::Test {
 protected:
  DriveOnBusTest() {
    // Node 1 turns the input; its brake is the node's own affair. The load is let loose by hand.
    Cycle();
    bench.load_servo().SetBrake(false);
  }
  void Cycle(int milliseconds = 1) {
    for (int i = 0; i < milliseconds; ++i) {
      bench.clock().SleepUntil(bench.clock().Now() + std::chrono::milliseconds(1));
      bus.Exchange(bench.clock().Now());
      drive.Cycle(bench.clock().Now());
      ReceivedFrame received;
      while (bus.end(0).Receive(received)) heard += ByEye(received.frame) + "\n";
    }
  }
  void Give(std::string_view frame) {
    ASSERT_EQ(bus.end(0).Send(ByHand(frame)), CanBus::Sent::kQueued);
    Cycle(2);
  }
  void Enable() {
    Give("000#01 01");
    Give("601#2F 60 60 00 09 00 00 00");  // cyclic velocity
    for (const char* word : {"201#06 00", "201#07 00", "201#0F 00"}) Give(word);
    ASSERT_EQ(node.power_state(), PowerState::kOperationEnabled);
  }

  SimulatedBench bench{analysis::model::DefaultPlantModel(), {}};
  InProcessCanBus bus{{}};
  ServoPhysics physics{bench.driving_servo(), UnitsOf(DriveEds(), 1)};
  DriveNode node{DriveEds(), 1, physics};
  DriveOnBus drive{bus.end(1), node};
  std::string heard;
};

TEST_F(DriveOnBusTest, TurnsTheInputAtTheSpeedThatItIsGiven) {
  EXPECT_EQ(bench.driving_servo().Actual().power, PowerState::kSwitchOnDisabled);
  Enable();
  Give("601#23 FF 60 00 00 00 05 00");  // five turns a second
  Cycle(1500);
  EXPECT_NEAR(bench.driving_servo().Actual().speed_rad_per_s, 5 * kTurn_rad, 0.02 * 5 * kTurn_rad);
  EXPECT_FALSE(bench.driving_servo().Actual().brake_engaged);
  heard.clear();
  Give("601#40 6C 60 00 00 00 00 00");
  EXPECT_EQ(heard.substr(0, 15), "581#43 6C 60 00") << heard;
}

TEST_F(DriveOnBusTest, StopsAndBrakesByQuickStop) {
  Enable();
  Give("601#23 FF 60 00 00 00 05 00");
  Cycle(500);
  Give("201#02 00");
  Cycle(300);
  EXPECT_EQ(node.power_state(), PowerState::kSwitchOnDisabled);
  EXPECT_EQ(bench.driving_servo().Actual().power, PowerState::kSwitchOnDisabled);
  EXPECT_TRUE(bench.driving_servo().Actual().brake_engaged);
  EXPECT_NEAR(bench.driving_servo().Actual().speed_rad_per_s, 0.0, 0.1);
}

TEST_F(DriveOnBusTest, StopsWhenTheMasterLeavesTheBus) {
  Give("601#23 16 10 01 64 00 10 00");  // node 16, 100 ms
  Enable();
  Give("601#23 FF 60 00 00 00 05 00");
  Give("710#05");
  Cycle(90);
  EXPECT_EQ(node.power_state(), PowerState::kOperationEnabled);
  bus.SetBusOff(0, true);
  Cycle(500);
  EXPECT_EQ(node.power_state(), PowerState::kFault);
  EXPECT_TRUE(bench.driving_servo().Actual().brake_engaged);
}

TEST_F(DriveOnBusTest, StopsWhenItsOwnControllerGivesUp) {
  Enable();
  Give("601#23 FF 60 00 00 00 05 00");
  bus.SetBusOff(1, true);
  Cycle(500);
  EXPECT_EQ(node.power_state(), PowerState::kFault);
  heard.clear();
  bus.SetBusOff(1, false);
  Cycle(3);
  EXPECT_NE(heard.find("081#40 81 "), std::string::npos) << heard;  // recovered from bus-off
}

TEST_F(DriveOnBusTest, BringsAFaultOfTheServoToTheBusAndResetsIt) {
  Enable();
  Injection injection;
  injection.driving_fault = true;
  bench.Inject(injection);
  Cycle(20);
  EXPECT_NE(heard.find("081#00 60 01 "), std::string::npos) << heard;
  EXPECT_EQ(node.power_state(), PowerState::kFault);
  bench.Inject({});
  Give("201#00 00");
  Give("201#80 00");
  Cycle(5);
  EXPECT_EQ(node.power_state(), PowerState::kSwitchOnDisabled);
  Enable();
}

TEST_F(DriveOnBusTest, KeepsAFrameThatTheBusDoesNotTake) {
  InProcessCanBus slow{{.bitrate = 10'000, .transmit_frames = 1}};
  DriveOnBus other{slow.end(1), node};
  ReceivedFrame received;
  std::string all;
  node.RaiseEmergency(0xFF01, {});
  node.RaiseEmergency(0xFF02, {});
  node.RaiseEmergency(0xFF03, {});
  for (int i = 1; i < 100; ++i) {
    const auto now = bench.clock().Now() + i * std::chrono::milliseconds(1);
    slow.Exchange(now);
    other.Cycle(now);
    while (slow.end(0).Receive(received)) all += ByEye(received.frame).substr(4, 5) + " ";
  }
  EXPECT_EQ(all, "01 FF 02 FF 03 FF ");
  EXPECT_EQ(other.sent(), 3U);
}

}  // namespace
}  // namespace strainwave::bench::drive_on_bus_test
