// SPDX-License-Identifier: Apache-2.0
// Set-points of an enabled drive, in each mode.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <cstdlib>

#include "tests/protocols/canopen/scripted_drive.h"

namespace strainwave::protocols::canopen::set_points_test {
namespace {

using enum OperationMode;

constexpr double kRadPerSPerRpm = 6.283185307179586 / 60.0;
constexpr double kRadPerCount = 6.283185307179586 / 4096.0;
constexpr std::uint16_t kBit12 = 0x1000;
constexpr std::uint16_t kBit13 = 0x2000;

TEST(SetPoints, SendsASpeedInProfileVelocity) {
  DriveBench bench;
  ASSERT_TRUE(bench.BringUp(kProfileVelocity));
  EXPECT_EQ(bench.master.CommandSpeed(1500.0 * kRadPerSPerRpm), DriveAnswer::kAccepted);
  bench.Cycle();
  EXPECT_EQ(bench.drive.target_velocity, 1500);
  EXPECT_EQ(bench.drive.controlword, 0x000F);
}

TEST(SetPoints, LeadsACyclicSpeedUpByTheAcceleration) {
  DriveBench bench;
  ASSERT_TRUE(bench.BringUp(kCyclicVelocity));
  bench.master.CommandSpeed(100.0);  // at 1000 rad/s²: 4 rad/s each 4 ms
  double speed = 0.0;
  for (int i = 1; i <= 30; ++i) {
    bench.Cycle();
    speed = std::min(100.0, 4.0 * i);
    EXPECT_EQ(bench.drive.target_velocity, std::lround(speed / kRadPerSPerRpm)) << i;
  }
  bench.master.CommandSpeed(0.0);
  bench.Cycle();
  EXPECT_EQ(bench.drive.target_velocity, std::lround(96.0 / kRadPerSPerRpm));
}

TEST(SetPoints, LeadsACyclicPositionNoFasterThanTheLimit) {
  DriveBench bench;
  bench.drive.position = 1000;
  ASSERT_TRUE(bench.BringUp(kCyclicPosition));
  const std::int32_t goal = 10000;
  bench.master.CommandPosition(goal * kRadPerCount);
  // 50 turns a second of 4096 counts in 4 ms.
  const int most = static_cast<int>(std::ceil(50.0 * 4096.0 * 0.004));
  std::int32_t last = 1000;
  int cycles = 0;
  for (; cycles < 100 && bench.drive.target_position != goal; ++cycles) {
    bench.Cycle();
    EXPECT_LE(std::abs(bench.drive.target_position - last), most);
    EXPECT_GE(bench.drive.target_position, last);
    last = bench.drive.target_position;
  }
  EXPECT_EQ(cycles, 11);  // 9000 counts of 819.2
}

TEST(SetPoints, LeadsNoFurtherAfterAGapInSync) {
  DriveProfile profile = EasyProfile();
  profile.timing.most_sync_deviation = std::chrono::seconds(1);
  DriveBench bench(profile);
  ASSERT_TRUE(bench.BringUp(kCyclicPosition));
  bench.master.CommandPosition(100000 * kRadPerCount);
  bench.Cycle();
  const std::int32_t before = bench.drive.target_position;
  bench.Cycle(std::chrono::milliseconds(100));
  EXPECT_LE(bench.drive.target_position - before, 2 * 820);
}

TEST(SetPoints, HandsOverAProfilePositionBySetPointAndAcknowledge) {
  DriveBench bench;
  ASSERT_TRUE(bench.BringUp(kProfilePosition));
  bench.Cycle();
  EXPECT_EQ(bench.drive.controlword, 0x002F);  // change at once; no set-point yet
  bench.master.CommandPosition(500 * kRadPerCount);
  bench.Cycle();
  EXPECT_EQ(bench.drive.target_position, 500);
  EXPECT_EQ(bench.drive.controlword, 0x002F);  // the target first, as it may wait for SYNC in the drive
  bench.Cycle();
  EXPECT_EQ(bench.drive.controlword, 0x003F);
  bench.master.CommandPosition(700 * kRadPerCount);  // waits for the drive
  bench.Cycle();
  EXPECT_EQ(bench.drive.target_position, 500);
  EXPECT_EQ(bench.drive.controlword, 0x003F);
  bench.drive.mode_bits |= kBit12;
  bench.Cycle();
  EXPECT_EQ(bench.drive.controlword, 0x002F);
  bench.Cycle();
  EXPECT_EQ(bench.drive.controlword, 0x002F);  // acknowledge is not yet taken back
  EXPECT_EQ(bench.drive.target_position, 500);
  bench.drive.mode_bits &= static_cast<std::uint16_t>(~kBit12);
  bench.Cycle();
  bench.Cycle();
  EXPECT_EQ(bench.drive.target_position, 700);
  bench.Cycle();
  EXPECT_EQ(bench.drive.controlword, 0x003F);
}

// 6064h goes over at 32 bits: the drive of 4096 counts a turn after 524 288 turns either way of its zero.
constexpr std::int64_t kWhole = std::int64_t{1} << 32;

std::int32_t AsSent(std::int64_t counts) { return static_cast<std::int32_t>(counts); }

TEST(SetPoints, CountOnEitherWayWhereThePositionGoesOver) {
  for (const std::int64_t step : {std::int64_t{1} << 29, -(std::int64_t{1} << 29)}) {
    DriveBench bench;
    ASSERT_TRUE(bench.BringUp(kCyclicTorque));
    std::int64_t counts = 0;
    for (int i = 0; i < 40; ++i, counts += step) {
      bench.drive.position = AsSent(counts);
      bench.Cycle();
      ASSERT_DOUBLE_EQ(bench.master.status().position_rad, static_cast<double>(counts) * kRadPerCount);
    }
    for (; counts != 0; counts -= step) {
      bench.drive.position = AsSent(counts);
      bench.Cycle();
      ASSERT_DOUBLE_EQ(bench.master.status().position_rad, static_cast<double>(counts) * kRadPerCount);
    }
  }
}

TEST(SetPoints, LeadACyclicPositionStraightOverTheEndOfThirtyTwoBits) {
  for (const int direction : {1, -1}) {
    DriveBench bench;
    bench.drive.position = direction > 0 ? INT32_MAX - 1000 : INT32_MIN + 1000;
    ASSERT_TRUE(bench.BringUp(kCyclicPosition));
    const std::int64_t from = bench.drive.position;
    const std::int64_t goal = from + direction * 5000;
    EXPECT_EQ(bench.master.CommandPosition(static_cast<double>(goal) * kRadPerCount), DriveAnswer::kAccepted);
    std::int64_t led = from;
    for (int i = 0; i < 20; ++i) {
      bench.Cycle();
      const std::int64_t way = AsSent(bench.drive.target_position - led);
      ASSERT_GE(direction * way, 0);
      ASSERT_LE(direction * way, 820);
      led += way;
    }
    EXPECT_EQ(led, goal);
  }
}

TEST(SetPoints, HandOverAProfilePositionBeyondTheEndOfThirtyTwoBits) {
  DriveBench bench;
  bench.drive.position = INT32_MAX - 1000;
  ASSERT_TRUE(bench.BringUp(kProfilePosition));
  const std::int64_t goal = bench.drive.position + std::int64_t{5000};
  EXPECT_EQ(bench.master.CommandPosition(static_cast<double>(goal) * kRadPerCount), DriveAnswer::kAccepted);
  bench.Cycle();
  EXPECT_EQ(bench.drive.target_position, AsSent(goal));
  EXPECT_LT(bench.drive.target_position, 0);
  // Half the numbers away, the drive would take the other way round.
  for (const std::int64_t far : {kWhole / 2, -kWhole / 2 - 1}) {
    const double position_rad = static_cast<double>(bench.drive.position + far) * kRadPerCount;
    EXPECT_EQ(bench.master.CommandPosition(position_rad), DriveAnswer::kNotANumber);
  }
}

TEST(SetPoints, SendsATorqueInPerMilleOfTheRated) {
  for (const OperationMode mode : {kProfileTorque, kCyclicTorque}) {
    DriveBench bench;
    ASSERT_TRUE(bench.BringUp(mode));
    bench.master.CommandTorque(-0.25);
    bench.Cycle();
    EXPECT_EQ(bench.drive.target_torque, -250);
  }
}

TEST(SetPoints, StartsAHomingByItsBitAndLowersItWhenAttained) {
  DriveBench bench;
  ASSERT_TRUE(bench.BringUp(kHoming));
  bench.Cycle();
  EXPECT_EQ(bench.drive.controlword, 0x000F);
  EXPECT_EQ(bench.master.StartHoming(), DriveAnswer::kAccepted);
  for (int i = 0; i < 5; ++i) {
    bench.Cycle();
    EXPECT_EQ(bench.drive.controlword, 0x001F);
  }
  bench.drive.mode_bits |= kBit12;
  bench.Cycle();
  EXPECT_EQ(bench.drive.controlword, 0x000F);
  EXPECT_TRUE(bench.master.status().bits.homing_attained);
  // A second one: the attained bit of the first does not end it.
  bench.master.StartHoming();
  bench.Cycle();
  EXPECT_EQ(bench.drive.controlword, 0x001F);
}

TEST(SetPoints, StopsOnAHomingErrorAndOnAFollowingError) {
  DriveBench homing;
  ASSERT_TRUE(homing.BringUp(kHoming));
  homing.master.StartHoming();
  homing.drive.mode_bits |= kBit13;
  homing.Cycle();
  EXPECT_EQ(homing.master.trouble(), DriveTrouble::kHomingFailed);

  for (const OperationMode mode : {kProfilePosition, kCyclicPosition}) {
    DriveBench bench;
    ASSERT_TRUE(bench.BringUp(mode));
    bench.drive.mode_bits |= kBit13;
    bench.Cycle();
    EXPECT_EQ(bench.master.trouble(), DriveTrouble::kFollowingError);
    EXPECT_EQ(bench.drive.power, PowerState::kQuickStopActive);
  }
  DriveBench torque;  // where bit 13 has no meaning
  ASSERT_TRUE(torque.BringUp(kCyclicTorque));
  torque.drive.mode_bits |= kBit13;
  torque.Cycle();
  EXPECT_EQ(torque.master.trouble(), DriveTrouble::kNone);
}

TEST(SetPoints, KeepsSetPointsWithinTheProfilesLimits) {
  DriveBench speed;
  ASSERT_TRUE(speed.BringUp(kProfileVelocity));
  speed.master.CommandSpeed(-1e6);
  speed.Cycle();
  EXPECT_EQ(speed.drive.target_velocity, -3000);
  DriveBench torque;
  ASSERT_TRUE(torque.BringUp(kProfileTorque));
  torque.master.CommandTorque(1e6);
  torque.Cycle();
  EXPECT_EQ(torque.drive.target_torque, 2000);
}

TEST(SetPoints, TakesNoSetPointThatIsNotANumberOrOfAnotherMode) {
  DriveBench bench;
  ASSERT_TRUE(bench.BringUp(kProfileVelocity));
  bench.master.CommandSpeed(10.0 * kRadPerSPerRpm);
  EXPECT_EQ(bench.master.CommandSpeed(std::nan("")), DriveAnswer::kNotANumber);
  EXPECT_EQ(bench.master.CommandSpeed(HUGE_VAL), DriveAnswer::kNotANumber);
  EXPECT_EQ(bench.master.CommandTorque(1.0), DriveAnswer::kNotEnabledInMode);
  EXPECT_EQ(bench.master.CommandPosition(1.0), DriveAnswer::kNotEnabledInMode);
  EXPECT_EQ(bench.master.StartHoming(), DriveAnswer::kNotEnabledInMode);
  bench.Cycle();
  EXPECT_EQ(bench.drive.target_velocity, 10);
  EXPECT_EQ(bench.drive.target_torque, 0);

  DriveBench position;
  ASSERT_TRUE(position.BringUp(kCyclicPosition));
  EXPECT_EQ(position.master.CommandPosition(1e13), DriveAnswer::kNotANumber);  // beyond all counting
}

}  // namespace
}  // namespace strainwave::protocols::canopen::set_points_test
