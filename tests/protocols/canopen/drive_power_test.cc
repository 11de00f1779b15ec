// SPDX-License-Identifier: Apache-2.0
// The power states of our drive, its ways to stop, and its brake.
#include <gtest/gtest.h>

#include "protocols/cia402.h"
#include "tests/protocols/canopen/drive_node_fixture.h"

namespace strainwave::protocols::canopen::device::drive_power_test {
namespace {

using enum PowerState;

class DrivePowerTest : public DriveNodeTest {
 protected:
  // In profile velocity at ten turns a second.
  void Turn() {
    Start();
    Enable(3);
    Set(0x60FF, 0, static_cast<std::int64_t>(10 * kTurn));
    Run(200);
    ASSERT_DOUBLE_EQ(motor.reading.speed_inc_per_s, 10 * kTurn);
  }
  unsigned Statusword() { return static_cast<unsigned>(Get(0x6041)); }
};

TEST_F(DrivePowerTest, WalksThePowerStatesAndReportsThem) {
  Start();
  EXPECT_EQ(node.power_state(), kSwitchOnDisabled);
  const auto after = [&](unsigned controlword) {
    Control(controlword);
    EXPECT_EQ(PowerStateOf(static_cast<std::uint16_t>(Statusword())), node.power_state());
    return node.power_state();
  };
  EXPECT_EQ(after(0x0F), kSwitchOnDisabled);
  EXPECT_EQ(after(0x06), kReadyToSwitchOn);
  EXPECT_EQ(after(0x07), kSwitchedOn);
  EXPECT_EQ(Statusword(), 0x4233U);
  EXPECT_EQ(after(0x0F), kOperationEnabled);
  EXPECT_EQ(Statusword() & 0x426FU, 0x0227U);
  EXPECT_EQ(after(0x07), kSwitchedOn);
  EXPECT_EQ(after(0x0F), kOperationEnabled);
  EXPECT_EQ(after(0x06), kReadyToSwitchOn);
  EXPECT_EQ(after(0x00), kSwitchOnDisabled);
}

TEST_F(DrivePowerTest, TakesTwoTransitionsOfOneControlwordInTwoCycles) {
  Start();
  Control(0x06);
  node.OnFrame(ByHand("201#0F 00"), now);
  EXPECT_EQ(node.power_state(), kSwitchedOn);
  Run();
  EXPECT_EQ(node.power_state(), kOperationEnabled);
}

TEST_F(DrivePowerTest, StopsQuicklyAsTheOptionSays) {
  struct Case {
    int option;
    int cycles;  // until the motor stands: ten turns a second by 6084h = 100, or by 6085h = 500 turns/s^2
    PowerState end;
  };
  for (const Case& c :
       {Case{0, 0, kSwitchOnDisabled}, Case{1, 100, kSwitchOnDisabled}, Case{2, 20, kSwitchOnDisabled},
        Case{5, 100, kQuickStopActive}, Case{6, 20, kQuickStopActive}}) {
    node.Reboot();
    motor.reading = {};
    Turn();
    Set(0x605A, 0, c.option);
    Control(0x02);
    if (c.option == 0) {
      EXPECT_EQ(node.power_state(), kSwitchOnDisabled);
      EXPECT_EQ(motor.command, DriveCommand{}) << "off, and the brake engaged";
      continue;
    }
    EXPECT_EQ(node.power_state(), kQuickStopActive);
    Run(c.cycles - 2);
    EXPECT_GT(motor.command.speed_inc_per_s, 0.0) << c.option;
    Run(1);
    EXPECT_NEAR(motor.command.speed_inc_per_s, 0.0, 1e-6) << c.option;
    EXPECT_EQ(node.power_state(), kQuickStopActive);
    Run(5);
    EXPECT_EQ(node.power_state(), c.end) << c.option;
    EXPECT_EQ(motor.command.loop, c.end == kQuickStopActive ? DriveLoop::kSpeed : DriveLoop::kOff);
  }
}

TEST_F(DrivePowerTest, ReturnsFromAQuickStopOnlyWhereItStays) {
  Turn();
  Set(0x605A, 0, 6);
  Control(0x02);
  Run(50);
  Set(0x60FF, 0, 0);
  Control(0x0F);
  EXPECT_EQ(node.power_state(), kOperationEnabled);  // transition 16
  Set(0x605A, 0, 2);
  Set(0x60FF, 0, static_cast<std::int64_t>(10 * kTurn));
  Run(200);
  Control(0x02);
  Control(0x0F);
  EXPECT_EQ(node.power_state(), kQuickStopActive) << "16 is not there under option 2";
  EXPECT_EQ(Set(0x605A, 0, 3), SdoAbort::kInvalidValue);
  EXPECT_EQ(Set(0x605A, 0, 7), SdoAbort::kValueTooHigh);
}

TEST_F(DrivePowerTest, ReactsToAFaultAsTheOptionSays) {
  for (const int option : {0, 1, 2}) {
    node.Reboot();
    motor.reading = {};
    Turn();
    Set(0x605E, 0, option);
    node.SetBusOff(true);
    Run();
    EXPECT_EQ(Get(0x603F), 0x8140);
    if (option == 0) {
      EXPECT_EQ(node.power_state(), kFault);
    } else {
      EXPECT_EQ(node.power_state(), kFaultReactionActive);
      Run(option == 1 ? 102 : 22);
      EXPECT_EQ(node.power_state(), kFault) << option;
    }
    EXPECT_EQ(motor.command, (DriveCommand{})) << option;
    node.SetBusOff(false);
  }
}

TEST_F(DrivePowerTest, HasNoRampLeftWhenItIsOutOfOrder) {
  Turn();
  motor.reading.out_of_order = true;
  Run();
  EXPECT_EQ(node.power_state(), kFault);
  EXPECT_EQ(motor.command, DriveCommand{});
  EXPECT_EQ(Get(0x603F), 0x6000);
}

TEST_F(DrivePowerTest, ResetsAFaultOnTheEdgeAndOnlyWhenItsCauseIsGone) {
  Start();
  motor.reading.out_of_order = true;
  Run();
  EXPECT_EQ(node.power_state(), kFault);
  Control(0x80);
  EXPECT_EQ(node.power_state(), kFault) << "the cause lasts";
  motor.reading.out_of_order = false;
  Run(3);
  EXPECT_EQ(node.power_state(), kFault) << "the bit is held";
  Control(0x00);
  EXPECT_EQ(Control(0x80), "081#00 00 00 00 00 00 00 00\n181#50 42");
  EXPECT_EQ(node.power_state(), kSwitchOnDisabled);
  EXPECT_EQ(Get(0x603F), 0);
  EXPECT_EQ(Get(0x1001), 0);
}

TEST_F(DrivePowerTest, TellsThePhysicsOfAReset) {
  Start();
  motor.reading.out_of_order = true;
  Run();
  motor.reading.out_of_order = false;
  Run();
  EXPECT_EQ(motor.resets, 0);
  Control(0x80);
  EXPECT_EQ(motor.resets, 1);
}

TEST_F(DrivePowerTest, HasNoPowerWhileSafeTorqueOffIsOpen) {
  Turn();
  motor.reading.safe_torque_off = true;
  EXPECT_EQ(Run(), "081#40 54 01 00 00 00 00 00\n181#40 42");
  EXPECT_EQ(motor.command, DriveCommand{});
  EXPECT_EQ(Get(0x60FD), 1 << 3);
  Control(0x06);
  EXPECT_EQ(node.power_state(), kSwitchOnDisabled);
  motor.reading.safe_torque_off = false;
  Control(0x06);
  EXPECT_EQ(node.power_state(), kReadyToSwitchOn);
  EXPECT_EQ(Get(0x60FD), 0);
}

TEST_F(DrivePowerTest, WorksTheBrakeByItselfUnlessTheMasterDoes) {
  Start();
  EXPECT_TRUE(motor.command.brake_engaged);
  EXPECT_EQ(Statusword() & 0x4000U, 0x4000U);
  Enable(3);
  EXPECT_FALSE(motor.command.brake_engaged);
  EXPECT_EQ(Statusword() & 0x4000U, 0U);
  Control(0x07);
  EXPECT_TRUE(motor.command.brake_engaged);
}

TEST_F(DrivePowerTest, LeavesTheBrakeToTheMasterAndTakesItInAnEmergency) {
  Turn();
  EXPECT_EQ(Get(0x60FE, 1), 1) << "with the mask alone a brake would open";
  Set(0x60FE, 1, 0);
  Set(0x60FE, 2, 1);
  Run();
  EXPECT_FALSE(motor.command.brake_engaged);
  Control(0x00);
  EXPECT_EQ(node.power_state(), kSwitchOnDisabled);
  EXPECT_FALSE(motor.command.brake_engaged) << "power off alone is the master's own";
  Set(0x60FE, 1, 1);
  Run();
  EXPECT_TRUE(motor.command.brake_engaged);
  Set(0x60FE, 1, 0);
  Enable(3);
  Control(0x02);
  EXPECT_FALSE(motor.command.brake_engaged) << "still turning";
  Run(30);
  EXPECT_EQ(node.power_state(), kSwitchOnDisabled);
  EXPECT_TRUE(motor.command.brake_engaged);
  EXPECT_EQ(Get(0x60FE, 1), 1) << "it stays so until the master opens it";
  Set(0x60FE, 1, 0);
  Run();
  EXPECT_FALSE(motor.command.brake_engaged);
  motor.reading.out_of_order = true;
  Run(2);
  EXPECT_TRUE(motor.command.brake_engaged);
}

TEST_F(DrivePowerTest, IsOffAndBrakedFromTheStartAndAfterAReset) {
  motor.command.loop = DriveLoop::kTorque;
  BootUp();
  EXPECT_EQ(motor.command, DriveCommand{});
  Turn();
  node.Reboot();
  EXPECT_EQ(motor.command, DriveCommand{});
  Run(5);
  EXPECT_EQ(node.power_state(), kSwitchOnDisabled);
  EXPECT_EQ(motor.command, DriveCommand{});
}

}  // namespace
}  // namespace strainwave::protocols::canopen::device::drive_power_test
