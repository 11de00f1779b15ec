// SPDX-License-Identifier: Apache-2.0
// What a node says of itself: boot-up, heartbeat, emergencies, and what it does when others go silent.
#include "protocols/canopen/drive_node.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <stdexcept>

#include "tests/protocols/canopen/drive_node_fixture.h"

namespace strainwave::protocols::canopen::device::drive_node_test {
namespace {

TEST_F(DriveNodeTest, SaysThatItHasBootedAndNothingElse) {
  EXPECT_EQ(Run(), "701#00");
  EXPECT_EQ(node.node_state(), NodeState::kPreOperational);
  EXPECT_EQ(Run(5000), "");
}

TEST_F(DriveNodeTest, FollowsTheMasterOfTheNetwork) {
  BootUp();
  const auto after = [&](std::string_view frame) {
    Give(frame);
    return node.node_state();
  };
  EXPECT_EQ(after("000#01 01"), NodeState::kOperational);
  EXPECT_EQ(after("000#02 00"), NodeState::kStopped);
  EXPECT_EQ(after("000#80 01"), NodeState::kPreOperational);
  EXPECT_EQ(after("000#01 02"), NodeState::kPreOperational) << "meant for another";
  EXPECT_EQ(after("000#01"), NodeState::kPreOperational);
  EXPECT_EQ(after("000#03 01"), NodeState::kPreOperational);
  EXPECT_EQ(after("000#81 01"), NodeState::kInitialising);
  EXPECT_EQ(Run(), "701#00");
  EXPECT_EQ(after("000#82 00"), NodeState::kInitialising);
  EXPECT_EQ(Run(), "701#00");
}

TEST_F(DriveNodeTest, AnswersSdoUnlessItIsStopped) {
  BootUp();
  EXPECT_EQ(Give("601#40 18 10 02 00 00 00 00"), "581#43 18 10 02 02 04 00 00");
  Give("000#02 01");
  EXPECT_EQ(Give("601#40 18 10 02 00 00 00 00"), "");
  Give("000#01 01");
  EXPECT_EQ(Give("601#40 18 10 01 00 00 00 00"), "581#43 18 10 01 57 53 00 00");
}

TEST_F(DriveNodeTest, GivesItsStateAsHeartbeat) {
  BootUp();
  EXPECT_EQ(Give("601#2B 17 10 00 0A 00 00 00"), "581#60 17 10 00 00 00 00 00");
  EXPECT_EQ(Run(20), "701#7F\n701#7F");
  Give("000#01 01");
  EXPECT_EQ(Run(10), "181#50 42\n701#05");  // switch on disabled, voltage enabled, remote, brake
  Give("000#02 01");
  EXPECT_EQ(Run(10), "701#04");
  node.faults().heartbeat_stops = true;
  EXPECT_EQ(Run(100), "");
}

TEST_F(DriveNodeTest, RestoresWhatAResetRestores) {
  BootUp();
  Set(0x1017, 0, 50);
  Set(0x6072, 0, 500);
  Give("000#82 01");
  Run();
  EXPECT_EQ(Get(0x1017), 0);
  EXPECT_EQ(Get(0x6072), 500) << "communication alone was reset";
  Give("000#81 01");
  Run();
  EXPECT_EQ(Get(0x6072), 3000);
}

// Heartbeat of node 16 every 100 ms at the latest; both 1029h and 6007h at their defaults.
TEST_F(DriveNodeTest, StopsWhenTheMasterGoesSilent) {
  ASSERT_EQ(Set(0x1016, 1, 0x00100064), std::nullopt);
  Start();
  Run(500);
  EXPECT_EQ(node.node_state(), NodeState::kOperational) << "never heard, so not missed";
  Enable(3);
  Give("710#05");
  Run(100);
  EXPECT_EQ(node.power_state(), PowerState::kOperationEnabled);
  // EMCY 8130h with communication and generic in the register; then TPDO 1 is out of order with the state.
  EXPECT_EQ(Run(), "081#30 81 11 00 00 00 00 00");
  EXPECT_EQ(node.node_state(), NodeState::kPreOperational);
  EXPECT_EQ(Get(0x603F), 0x8130);
  EXPECT_EQ(Get(0x1001), 0x11);
  EXPECT_EQ(Get(0x1003, 0), 1);
  EXPECT_EQ(Get(0x1003, 1), 0x8130);
  Run();
  EXPECT_EQ(node.power_state(), PowerState::kFault);
  EXPECT_EQ(motor.command.loop, DriveLoop::kOff);
  // Only its return ends it, and a reset of the fault the fault.
  Set(0x6040, 0, 0x80);
  Run();
  EXPECT_EQ(node.power_state(), PowerState::kFault);
  Give("710#05");
  EXPECT_EQ(Run(), "081#00 00 00 00 00 00 00 00");
  Set(0x6040, 0, 0x00);
  Run();
  Set(0x6040, 0, 0x80);
  Run();
  EXPECT_EQ(node.power_state(), PowerState::kSwitchOnDisabled);
  EXPECT_EQ(Get(0x1001), 0);
}

TEST_F(DriveNodeTest, DoesWhatTheAbortOptionAndTheErrorBehaviourSay) {
  struct Case {
    int abort_option;
    int error_behaviour;
    PowerState power;
    NodeState node;
  };
  constexpr Case kCases[] = {
      {0, 1, PowerState::kOperationEnabled, NodeState::kOperational},
      {1, 0, PowerState::kFaultReactionActive, NodeState::kPreOperational},
      {2, 1, PowerState::kSwitchOnDisabled, NodeState::kOperational},
      {3, 2, PowerState::kQuickStopActive, NodeState::kStopped},
  };
  Start();
  for (const Case& c : kCases) {
    node.Reboot();
    Start();
    Set(0x1016, 1, 0x00100064);
    Set(0x6007, 0, c.abort_option);
    Set(0x1029, 1, c.error_behaviour);
    Enable(3);
    Give("710#05");
    Run(101);
    EXPECT_EQ(node.power_state(), c.power) << c.abort_option;
    EXPECT_EQ(node.node_state(), c.node) << c.abort_option;
  }
}

TEST_F(DriveNodeTest, IgnoresTheToggleBitAndWatchesNoNodeTwice) {
  BootUp();
  EXPECT_EQ(Set(0x1016, 1, 0x00100064), std::nullopt);
  EXPECT_EQ(Set(0x1016, 2, 0x00100032), SdoAbort::kParameterIncompatible);
  EXPECT_EQ(Set(0x1016, 2, 0x00110032), std::nullopt);
  EXPECT_EQ(Set(0x1016, 1, 0x00800064), SdoAbort::kInvalidValue);
  Give("710#85");
  EXPECT_EQ(Run(101), "081#30 81 11 00 00 00 00 00");
}

TEST_F(DriveNodeTest, SupervisesTheSync) {
  Set(0x1006, 0, 10000);
  Start();
  Run(100);
  Enable(9);
  Give("080#");
  Run(20);
  EXPECT_EQ(node.power_state(), PowerState::kOperationEnabled);
  EXPECT_EQ(Run(), "081#00 87 21 00 00 00 00 00\n181#1F 06");
  EXPECT_EQ(Give("080#01"), "081#40 82 31 00 00 00 00 00") << "a SYNC with a counter that nobody asked for";
}

TEST_F(DriveNodeTest, TakesSyncsWithACounterWhereItIsToldTo) {
  EXPECT_EQ(Set(0x1019, 0, 1), SdoAbort::kInvalidValue);
  EXPECT_EQ(Set(0x1019, 0, 241), SdoAbort::kValueTooHigh);
  EXPECT_EQ(Set(0x1019, 0, 240), std::nullopt);
  EXPECT_EQ(Set(0x1006, 0, 10000), std::nullopt);
  EXPECT_EQ(Set(0x1019, 0, 0), SdoAbort::kCannotStoreDeviceState) << "while SYNC is supervised";
  Start();
  for (const char* sync : {"080#01", "080#02", "080#F0", "080#01"}) {
    EXPECT_EQ(Give(sync).find("40 82"), std::string::npos) << sync;
  }
  EXPECT_EQ(Give("080#"), "081#40 82 11 00 00 00 00 00");
}

TEST_F(DriveNodeTest, TellsWhatTheMakerTells) {
  BootUp();
  Set(0x1015, 0, 50);  // 5 ms
  node.RaiseEmergency(0xFF10, {1, 2, 3, 4, 5});
  node.RaiseEmergency(0x2310, {});
  node.RaiseEmergency(0x2310, {});
  EXPECT_EQ(AllOf(node), "081#10 FF 81 01 02 03 04 05");
  EXPECT_EQ(Run(4), "");
  EXPECT_EQ(Run(), "081#10 23 83 00 00 00 00 00");
  EXPECT_EQ(Get(0x1003, 0), 2);
  EXPECT_EQ(Get(0x1003, 1), 0x2310);
  EXPECT_EQ(Get(0x1003, 2), 0x0201FF10);
  EXPECT_EQ(Set(0x1003, 0, 1), SdoAbort::kInvalidValue);
  EXPECT_EQ(Set(0x1003, 0, 0), std::nullopt);
  EXPECT_EQ(Get(0x1003, 1), 0);
  node.ClearEmergency(0x2310);
  EXPECT_EQ(Run(5), "081#00 00 81 00 00 00 00 00");
}

TEST_F(DriveNodeTest, StopsAtBusOffAndTellsOfItAfterwards) {
  Start();
  Enable(3);
  node.SetBusOff(true);
  EXPECT_EQ(node.power_state(), PowerState::kFaultReactionActive);
  EXPECT_EQ(node.node_state(), NodeState::kPreOperational);
  node.SetBusOff(false);
  EXPECT_EQ(AllOf(node).substr(0, 12), "081#40 81 11");
}

TEST_F(DriveNodeTest, StopsWhenItIsTakenOutOfOperational) {
  Start();
  Enable(3);
  Give("000#80 01");
  EXPECT_EQ(node.power_state(), PowerState::kFaultReactionActive);
  EXPECT_EQ(Get(0x603F), 0x8100);
}

TEST_F(DriveNodeTest, MisbehavesOnCommand) {
  node.faults().product_number = 0x403;
  BootUp();
  EXPECT_EQ(Give("601#40 18 10 02 00 00 00 00"), "581#43 18 10 02 03 04 00 00");
  Give("000#01 01");
  EXPECT_EQ(Run(), "181#50 42");
  node.faults().stuck_statusword = 0x1234;
  EXPECT_EQ(Run(), "181#34 12");
  node.faults().pdo_length_change = 2;
  node.faults().stuck_statusword = 0x5678;
  EXPECT_EQ(Run(), "181#78 56 00 00");
  node.faults().pdo_length_change = -1;
  node.faults().stuck_statusword.reset();
  EXPECT_EQ(Run(), "181#50");
  node.faults().mode_not_confirmed = true;
  Set(0x6060, 0, 3);
  Run();
  EXPECT_EQ(Get(0x6060), 3);
  EXPECT_EQ(Get(0x6061), 0);
  node.objects().Refuse({0x6060, 0}, SdoAbort::kHardwareError);
  EXPECT_EQ(Give("601#40 60 60 00 00 00 00 00"), "581#80 60 60 00 00 00 06 06");
  node.Reboot();
  EXPECT_EQ(Run(), "701#00");
}

TEST_F(DriveNodeTest, SaysNothingAndHearsNothingWhileItIsSilent) {
  Set(0x1017, 0, 10);
  Start();
  node.faults().silent = true;
  EXPECT_EQ(Give("601#40 18 10 02 00 00 00 00"), "");
  EXPECT_EQ(Run(35), "");
  Give("000#02 01");
  node.faults().silent = false;
  EXPECT_EQ(node.node_state(), NodeState::kOperational);
  EXPECT_EQ(Run(10), "701#05") << "what it would have said meanwhile must not come later";
}

// Frames of any id, length and content, most of them at the services of this node.
TEST_F(DriveNodeTest, OutlivesWhateverComes) {
  std::mt19937 random(7);
  const auto pick = [&](std::uint32_t count) { return static_cast<std::uint32_t>(random() % count); };
  constexpr std::uint32_t kIds[] = {0x000, 0x080, 0x201, 0x301, 0x401, 0x501, 0x601, 0x601, 0x601, 0x710};
  Start();
  int answers = 0;
  for (int i = 0; i < 300000; ++i) {
    CanFrame frame;
    frame.id = pick(20) == 0 ? pick(0x800) : kIds[pick(std::size(kIds))];
    frame.length = static_cast<std::uint8_t>(pick(4) == 0 ? pick(9) : 8);
    for (std::size_t j = 0; j < frame.length; ++j) frame.data[j] = static_cast<std::uint8_t>(pick(256));
    if (frame.id == 0x601 && pick(2) == 0) {  // at an object that there is
      constexpr std::uint16_t kIndices[] = {0x1003, 0x1014, 0x1016, 0x1017, 0x1400,
                                            0x1600, 0x1A00, 0x2000, 0x6040, 0x6092};
      const std::uint16_t index = kIndices[pick(std::size(kIndices))];
      frame.data[1] = static_cast<std::uint8_t>(index & 0xFF);
      frame.data[2] = static_cast<std::uint8_t>(index >> 8);
      frame.data[3] = static_cast<std::uint8_t>(pick(9));
    }
    frame.remote = pick(50) == 0;
    frame.extended = pick(50) == 0;
    node.OnFrame(frame, now);
    CanFrame answer;
    for (int j = 0; j < 200 && node.Next(answer); ++j, ++answers) ASSERT_LE(answer.length, 8);
    if (pick(3) == 0) Run();
    ASSERT_TRUE(std::isfinite(motor.command.position_inc) && std::isfinite(motor.command.speed_inc_per_s));
    if (std::abs(motor.reading.position_inc) > 1e12) motor.reading.position_inc = 0.0;
  }
  EXPECT_GT(answers, 10000);
  Give("000#81 01");
  EXPECT_EQ(Run(), "701#00");
  EXPECT_EQ(Give("601#40 18 10 02 00 00 00 00"), "581#43 18 10 02 02 04 00 00");
}

TEST(DriveNode, NamesTheObjectThatItsFileLacks) {
  EdsFile eds = DriveEds();
  eds.objects.erase({0x6065, 0});
  ObedientMotor motor;
  try {
    DriveNode node(eds, 1, motor);
    FAIL() << "no std::invalid_argument";
  } catch (const std::invalid_argument& error) {
    EXPECT_STREQ(error.what(), "the device has no object 6065:00 (its EDS file must have it)");
  }
}

}  // namespace
}  // namespace strainwave::protocols::canopen::device::drive_node_test
