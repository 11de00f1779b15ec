// SPDX-License-Identifier: Apache-2.0
#include "protocols/canopen/drive_units.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace strainwave::protocols::canopen::drive_units_test {
namespace {

constexpr double kTwoPi = 6.283185307179586;

// A motor with 20-bit encoder behind a gear of 3, counting the other way; speeds in tenths of rpm.
constexpr DriveUnits kUnits{.position_counts_per_rev = 1048576.0,
                            .velocity_units_per_rpm = 10.0,
                            .acceleration_units_per_rpm_per_s = 0.5,
                            .rated_torque_Nm = 1.27,
                            .gear_ratio = 3.0,
                            .sign = -1};

TEST(DriveUnits, ConvertKnownValues) {
  EXPECT_EQ(PositionCounts(kUnits, kTwoPi / 3.0), -1048576);          // one turn of the motor
  EXPECT_EQ(VelocityUnits(kUnits, kTwoPi * 100.0 / 60.0), -3000);     // 100 rpm: 300 rpm of the motor
  EXPECT_EQ(TorquePerMille(kUnits, 1.27 * 3.0), -1000);               // rated
  EXPECT_EQ(AccelerationUnits(kUnits, kTwoPi * 100.0 / 60.0), 150U);  // 300 rpm/s of the motor
  EXPECT_EQ(VelocityLimitUnits(kUnits, kTwoPi * 100.0 / 60.0), 3000U);
  EXPECT_EQ(TorqueLimitPerMille(kUnits, 1.27 * 3.0 * 1.5), 1500U);
  EXPECT_EQ(PositionWindowCounts(kUnits, kTwoPi / 3.0), 1048576U);
}

// Point 12.
TEST(DriveUnits, ComeBackFromARoundTripToTheSameCount) {
  for (const int sign : {1, -1}) {
    for (const double gear_ratio : {1.0, 3.0, 80.0}) {
      DriveUnits units = kUnits;
      units.sign = sign;
      units.gear_ratio = gear_ratio;
      for (std::int64_t number = -2147483648; number <= 2147483647; number += 1234567) {
        const auto count = static_cast<std::int32_t>(number);
        ASSERT_EQ(PositionCounts(units, PositionRad(units, count)), count);
        ASSERT_EQ(VelocityUnits(units, SpeedRadPerS(units, count)), count);
      }
      for (int per_mille = -32768; per_mille <= 32767; ++per_mille) {
        const auto torque = static_cast<std::int16_t>(per_mille);
        ASSERT_EQ(TorquePerMille(units, TorqueNm(units, torque)), torque);
      }
    }
  }
}

TEST(DriveUnits, AreNearestAndNotCut) {
  DriveUnits units;
  units.position_counts_per_rev = kTwoPi;  // one count a radian
  EXPECT_EQ(PositionCounts(units, 1.6), 2);
  EXPECT_EQ(PositionCounts(units, -1.6), -2);
}

TEST(DriveUnits, CountPositionsOnBeyondThirtyTwoBits) {
  constexpr std::int64_t kCounts = -(std::int64_t{1} << 40) - 7;
  EXPECT_EQ(PositionCounts(kUnits, PositionRad(kUnits, kCounts)), kCounts);
}

TEST(DriveUnits, GiveNothingForWhatTheDriveCannotCount) {
  for (const double value : {std::nan(""), HUGE_VAL, -HUGE_VAL, 1e18}) {
    EXPECT_EQ(PositionCounts(kUnits, value), std::nullopt);
    EXPECT_EQ(VelocityUnits(kUnits, value), std::nullopt);
    EXPECT_EQ(TorquePerMille(kUnits, value), std::nullopt);
  }
  EXPECT_EQ(TorquePerMille(kUnits, 200.0), std::nullopt);  // 52 493 per mille
}

TEST(DriveUnits, CutLimitsToTheLargestNumberAndNeverSwitchTheWindowOff) {
  EXPECT_EQ(VelocityLimitUnits(kUnits, 1e12), 0xFFFFFFFFU);
  EXPECT_EQ(PositionWindowCounts(kUnits, 1e12), 0xFFFFFFFEU);
  EXPECT_EQ(TorqueLimitPerMille(kUnits, 1e6), 0xFFFFU);
  EXPECT_EQ(VelocityLimitUnits(kUnits, std::nan("")), 0U);
}

}  // namespace
}  // namespace strainwave::protocols::canopen::drive_units_test
