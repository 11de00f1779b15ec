// SPDX-License-Identifier: Apache-2.0
// The modes of operation of our drive, as a master sees them.
#include "protocols/canopen/drive_motion.h"

#include <gtest/gtest.h>

#include <limits>

#include "tests/protocols/canopen/drive_node_fixture.h"

namespace strainwave::protocols::canopen::device::drive_motion_test {
namespace {

constexpr unsigned kReached = 1U << 10;
constexpr unsigned kLimited = 1U << 11;
constexpr unsigned kModeBit = 1U << 12;
constexpr unsigned kFollowing = 1U << 13;

class DriveMotionTest : public DriveNodeTest {
 protected:
  using DriveNodeTest::DriveNodeTest;
  void Begin(int mode) {
    Start();
    Enable(mode);
    Run();
  }
  unsigned Bits() { return static_cast<unsigned>(Get(0x6041)) & 0x3C00U; }
  void SetTurns(std::uint16_t index, double turns) {
    ASSERT_EQ(Set(index, 0, static_cast<std::int64_t>(turns * kTurn)), std::nullopt);
  }
  double Speed() const { return motor.command.speed_inc_per_s / kTurn; }
  double Place() const { return motor.command.position_inc / kTurn; }
};

TEST_F(DriveMotionTest, RampsItsSpeedUpAndDown) {
  Begin(3);
  EXPECT_EQ(Bits(), kModeBit);  // stands; at its target from 5 ms on
  Run(5);
  EXPECT_EQ(Bits(), kModeBit | kReached);
  SetTurns(0x60FF, -20);  // by 100 turns/s^2: 200 ms
  Run(100);
  EXPECT_NEAR(Speed(), -10.0, 1e-6);
  EXPECT_EQ(Bits(), 0U);
  EXPECT_EQ(Get(0x606B), -655360);
  Run(110);
  EXPECT_DOUBLE_EQ(Speed(), -20.0);
  EXPECT_EQ(Bits(), kReached);
  EXPECT_EQ(Get(0x606C), static_cast<std::int64_t>(-20 * kTurn));
  Control(0x10F);  // halt, by 6084h
  Run(99);
  EXPECT_NEAR(Speed(), -10.0, 1e-6);
  Run(120);
  EXPECT_EQ(Speed(), 0.0);
  EXPECT_EQ(node.power_state(), PowerState::kOperationEnabled);
  Control(0x0F);
  Run(210);
  EXPECT_DOUBLE_EQ(Speed(), -20.0);
}

TEST_F(DriveMotionTest, IsNoFasterThanItsLimits) {
  Begin(9);
  SetTurns(0x60FF, 60);
  Run(2);
  EXPECT_DOUBLE_EQ(Speed(), 50.0);  // 3000 turns a minute, and 607Fh the same
  EXPECT_EQ(Bits(), kModeBit | kLimited);
  Set(0x6080, 0, 600);
  Run();
  EXPECT_DOUBLE_EQ(Speed(), 10.0);
  Set(0x607F, 0, static_cast<std::int64_t>(5 * kTurn));
  Run();
  EXPECT_DOUBLE_EQ(Speed(), 5.0);
  SetTurns(0x60FF, 4);
  Run();
  EXPECT_DOUBLE_EQ(Speed(), 4.0);
  EXPECT_EQ(Bits(), kModeBit);
}

TEST_F(DriveMotionTest, GoesToAPlaceAndSaysWhenItIsThere) {
  Begin(1);
  SetTurns(0x6081, 10);
  SetTurns(0x607A, 3);
  Control(0x1F);
  EXPECT_EQ(Bits(), kModeBit) << "the set point is taken";
  Control(0x0F);
  EXPECT_EQ(Bits(), 0U);
  double fastest = 0.0;
  double last = 0.0;
  for (int i = 0; i < 600; ++i) {
    Run();
    EXPECT_GE(Place(), last) << "no way back";
    last = Place();
    fastest = std::max(fastest, Speed());
  }
  EXPECT_DOUBLE_EQ(fastest, 10.0);
  EXPECT_DOUBLE_EQ(Place(), 3.0);
  EXPECT_EQ(Bits(), kReached);
  EXPECT_EQ(Get(0x6064), static_cast<std::int64_t>(3 * kTurn));
  // Once more from here, relative, with the bit falling and rising.
  SetTurns(0x607A, -1);
  Control(0x5F);
  EXPECT_EQ(Bits(), kModeBit);
  Control(0x0F);
  Run(500);
  EXPECT_DOUBLE_EQ(Place(), 2.0);
}

TEST_F(DriveMotionTest, KeepsOneSetPointWaitingOrTakesItAtOnce) {
  Begin(1);
  SetTurns(0x607A, 2);
  Control(0x1F);
  Control(0x0F);
  SetTurns(0x607A, -1);
  Control(0x1F);
  Control(0x0F);
  EXPECT_EQ(Bits(), kModeBit) << "the buffer is full";
  double furthest = 0.0;
  for (int i = 0; i < 1500; ++i) {
    Run();
    furthest = std::max(furthest, Place());
  }
  EXPECT_DOUBLE_EQ(furthest, 2.0);
  EXPECT_DOUBLE_EQ(Place(), -1.0);
  SetTurns(0x607A, 5);
  Control(0x1F);
  Control(0x0F);
  Run(50);
  SetTurns(0x607A, 0);
  Control(0x3F);  // at once
  Control(0x0F);
  furthest = 0.0;
  for (int i = 0; i < 1500; ++i) {
    Run();
    furthest = std::max(furthest, Place());
  }
  EXPECT_LT(furthest, 2.0);
  EXPECT_DOUBLE_EQ(Place(), 0.0);
}

TEST_F(DriveMotionTest, TakesTheShortWayWherePositionsCountOver) {
  const double far = std::numeric_limits<std::int32_t>::max() - 10.0;
  motor.reading.position_inc = far;
  Set(0x607A, 0, 2147483637);
  Begin(8);
  EXPECT_EQ(Get(0x6064), 2147483637);
  Set(0x607A, 0, -2147483648 + 9);  // 20 further on
  Run(2);
  EXPECT_DOUBLE_EQ(motor.command.position_inc, far + 20.0);
  Run(2);
  EXPECT_EQ(Get(0x6064), -2147483648 + 9);
}

TEST_F(DriveMotionTest, FollowsCyclicPositionsAsFastAsItMay) {
  Begin(8);
  EXPECT_EQ(Bits(), kModeBit);
  SetTurns(0x607A, 0.02);
  Run();
  EXPECT_DOUBLE_EQ(Place(), 1310.0 / kTurn);
  EXPECT_EQ(Bits(), kModeBit);
  SetTurns(0x607A, 1.0);  // 50 turns a second at most
  Run();
  EXPECT_NEAR(Place(), 1310.0 / kTurn + 0.05, 1e-9);
  EXPECT_EQ(Bits(), kModeBit | kLimited);
}

// Targets every 40 ms, as by SYNC: a quarter of the way in each 10 ms, and no step.
TEST_F(DriveMotionTest, GoesStraightToEachCyclicTargetOverTheInterpolationTime) {
  Begin(9);
  Set(0x60C2, 1, 40);
  SetTurns(0x60FF, 4);
  Run(10);
  EXPECT_NEAR(Speed(), 1.0, 1e-9);
  Run(30);
  EXPECT_DOUBLE_EQ(Speed(), 4.0);
  SetTurns(0x60FF, 8);
  double last = 4.0;
  for (int i = 0; i < 40; ++i) {
    Run();
    EXPECT_NEAR(Speed() - last, 0.1, 1e-9);
    last = Speed();
  }
  Run(20);
  EXPECT_DOUBLE_EQ(Speed(), 8.0) << "the next target is late: the last one holds";
  SetTurns(0x60FF, 4);
  Run(10);
  SetTurns(0x60FF, 0);  // early: from where it is
  Run(20);
  EXPECT_NEAR(Speed(), 3.5, 1e-9);
  Set(0x6060, 0, 10);
  Set(0x6071, 0, 80);
  Run(10);
  EXPECT_NEAR(motor.command.torque_permille, 20.0, 1e-9);
  Run(30);
  EXPECT_DOUBLE_EQ(motor.command.torque_permille, 80.0);
}

TEST_F(DriveMotionTest, GoesStraightToEachCyclicPosition) {
  Begin(8);
  Set(0x60C2, 1, 4);
  Set(0x60C2, 2, -2);
  SetTurns(0x607A, 1.0);
  Run(10);
  EXPECT_NEAR(Place(), 0.25, 1e-9);
  EXPECT_NEAR(Speed(), 25.0, 1e-6);
  Run(30);
  EXPECT_DOUBLE_EQ(Place(), 1.0);
  Run();
  EXPECT_EQ(Speed(), 0.0);
}

TEST_F(DriveMotionTest, GivesUpWhenTheMotorDoesNotFollow) {
  Begin(8);
  Set(0x6065, 0, 1000);
  Set(0x6066, 0, 10);
  motor.stuck = true;
  SetTurns(0x607A, 0.02);  // 1310 increments away
  EXPECT_EQ(Run(9), "") << "not yet for 10 ms (6066h)";
  EXPECT_EQ(Bits(), kModeBit);
  EXPECT_EQ(node.power_state(), PowerState::kOperationEnabled);
  EXPECT_EQ(Get(0x60F4), 1310);
  EXPECT_EQ(Run(), "081#11 86 21 00 00 00 00 00\n181#1F 32");
  EXPECT_EQ(Get(0x603F), 0x8611);
  Run(2);
  EXPECT_EQ(node.power_state(), PowerState::kFault);
}

TEST_F(DriveMotionTest, FollowsFreelyWithoutAWindow) {
  Begin(8);
  Set(0x6065, 0, 0xFFFFFFFF);
  motor.stuck = true;
  SetTurns(0x607A, 100);
  Run(1000);
  EXPECT_EQ(node.power_state(), PowerState::kOperationEnabled);
}

TEST_F(DriveMotionTest, RampsItsTorqueWithinTheLimit) {
  Begin(4);
  Set(0x6087, 0, 10000);  // 10 per mille a cycle
  Set(0x6071, 0, 100);
  Run(5);
  EXPECT_DOUBLE_EQ(motor.command.torque_permille, 50.0);
  EXPECT_EQ(Bits(), 0U);
  Run(5);
  EXPECT_DOUBLE_EQ(motor.command.torque_permille, 100.0);
  EXPECT_EQ(Bits(), kReached);
  EXPECT_EQ(Get(0x6074), 100);
  Set(0x6072, 0, 80);
  Run(5);
  EXPECT_DOUBLE_EQ(motor.command.torque_permille, 80.0);
  EXPECT_EQ(motor.command.torque_limit_permille, 80.0);
  EXPECT_EQ(Bits(), kReached | kLimited);
  Set(0x6071, 0, -32768);
  Run(100);
  EXPECT_DOUBLE_EQ(motor.command.torque_permille, -80.0);
}

TEST_F(DriveMotionTest, DrivesAMotorThatIsTooFastNoFurther) {
  Begin(10);
  Set(0x6071, 0, 100);
  Run();
  EXPECT_DOUBLE_EQ(motor.command.torque_permille, 100.0);
  EXPECT_EQ(Bits(), kModeBit);
  motor.reading.speed_inc_per_s = 51 * kTurn;
  Run();
  EXPECT_EQ(motor.command.torque_permille, 0.0);
  EXPECT_EQ(Bits(), kModeBit | kLimited);
  Set(0x6071, 0, -100);  // against the motion it helps
  Run();
  EXPECT_DOUBLE_EQ(motor.command.torque_permille, -100.0);
}

TEST_F(DriveMotionTest, MakesItsPlaceItsHome) {
  motor.reading.position_inc = 12345;
  Set(0x607C, 0, 100);
  Begin(6);
  EXPECT_EQ(Bits(), kReached);
  Control(0x1F);
  EXPECT_EQ(Bits(), kReached | kModeBit);
  EXPECT_EQ(Get(0x6064), 100);
  EXPECT_DOUBLE_EQ(motor.command.position_inc, 12345.0) << "the shaft stays";
  EXPECT_EQ(Set(0x6098, 0, 36), SdoAbort::kInvalidValue);
  EXPECT_EQ(Set(0x6098, 0, 1), SdoAbort::kValueTooLow);
}

TEST_F(DriveMotionTest, StartsFromWhereItIsInEachMode) {
  motor.reading.position_inc = 5000;
  Begin(1);
  EXPECT_DOUBLE_EQ(motor.command.position_inc, 5000.0) << "no set point was given";
  Control(0x07);
  motor.reading.position_inc = 7000;
  Enable(1);
  Run();
  EXPECT_DOUBLE_EQ(motor.command.position_inc, 7000.0);
  Set(0x6060, 0, 3);
  Run();
  EXPECT_EQ(Speed(), 0.0);
  EXPECT_EQ(Get(0x6061), 3);
}

TEST_F(DriveMotionTest, HasNoTorqueWithoutAMode) {
  Begin(0);
  EXPECT_EQ(motor.command.loop, DriveLoop::kTorque);
  EXPECT_EQ(motor.command.torque_permille, 0.0);
}

TEST_F(DriveMotionTest, RefusesModesThatItDoesNotHave) {
  Start();
  for (const int mode : {2, 5, 7, 11, -1}) EXPECT_EQ(Set(0x6060, 0, mode), SdoAbort::kInvalidValue) << mode;
  for (const int mode : {0, 1, 3, 4, 6, 8, 9, 10}) EXPECT_EQ(Set(0x6060, 0, mode), std::nullopt) << mode;
}

// 80 turns of the motor are one of the shaft, of 360000 units; 1000 increments a turn of the motor.
EdsFile GearedEds() {
  EdsFile eds = DriveEds();
  eds.objects.at({0x608F, 1}).default_value = "1000";
  eds.objects.at({0x6091, 1}).default_value = "80";
  eds.objects.at({0x6092, 1}).default_value = "360000";
  return eds;
}
class GearedDriveTest : public DriveMotionTest {
 protected:
  GearedDriveTest() : DriveMotionTest(GearedEds()) {}
};

TEST_F(GearedDriveTest, WorksInTheUnitsThatItsObjectsState) {
  motor.reading.position_inc = 40000;  // half a turn of the shaft
  Begin(9);
  EXPECT_EQ(Get(0x6064), 180000);
  Set(0x60FF, 0, 90000);  // a quarter turn of the shaft a second: 20 of the motor
  Run();
  EXPECT_DOUBLE_EQ(motor.command.speed_inc_per_s, 20000.0);
  Set(0x6080, 0, 600);  // ten turns of the motor a second
  Run();
  EXPECT_DOUBLE_EQ(motor.command.speed_inc_per_s, 10000.0);
}

EdsFile TorqueEds() {
  EdsFile eds = DriveEds();
  eds.objects.at({0x6502, 0}).default_value = "0x208";
  return eds;
}
class TorqueDriveTest : public DriveMotionTest {
 protected:
  TorqueDriveTest() : DriveMotionTest(TorqueEds()) {}
};

TEST_F(TorqueDriveTest, StopsByTakingItsTorqueAway) {
  Begin(10);
  EXPECT_EQ(Set(0x6060, 0, 3), SdoAbort::kInvalidValue);
  Set(0x6071, 0, 500);
  Run();
  EXPECT_DOUBLE_EQ(motor.command.torque_permille, 500.0);
  Control(0x02);
  EXPECT_EQ(motor.command.loop, DriveLoop::kTorque);
  Run(24);
  EXPECT_NEAR(motor.command.torque_permille, 250.0, 1e-9);
  Run(26);
  EXPECT_EQ(node.power_state(), PowerState::kSwitchOnDisabled);
  EXPECT_EQ(motor.command.loop, DriveLoop::kOff);
}

}  // namespace
}  // namespace strainwave::protocols::canopen::device::drive_motion_test
