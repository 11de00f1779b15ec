// SPDX-License-Identifier: Apache-2.0
#include "daq/value_bounds.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>

namespace strainwave::daq::value_bounds_test {
namespace {

TEST(ValueBounds, AreThoseOfTheUnitThatANameEndsIn) {
  EXPECT_EQ(BoundsOf("accel_motor_z_m_per_s2").Text(), "a number from -1e+07 to 1e+07 m/s^2");
  EXPECT_EQ(BoundsOf("torque_Nm").Text(), "a number from -1e+06 to 1e+06 Nm");
  EXPECT_EQ(BoundsOf("temperature_degC").Text(), "a number from -273.15 to 5000 degC");
  EXPECT_EQ(BoundsOf("sample_rate_hz").Text(), "a number from 1e-06 to 1e+09 hz");
  EXPECT_EQ(BoundsOf("k2_Nm_per_rad").Text(), "a number from -1e+12 to 1e+12 Nm/rad");
  EXPECT_EQ(BoundsOf("ratio").Text(), "a number from -1e+06 to 1e+06");
  EXPECT_EQ(BoundsOf("mic_Pa").Text(), "a number from -1e+30 to 1e+30");
}

TEST(ValueBounds, HoldTheirEndsAndNothingBeyondAndNoNaN) {
  const ValueBounds& bounds = BoundsOf("temperature_degC");
  EXPECT_TRUE(bounds.Hold(-273.15));
  EXPECT_TRUE(bounds.Hold(5000.0));
  EXPECT_FALSE(bounds.Hold(std::nextafter(-273.15, -1e3)));
  EXPECT_FALSE(bounds.Hold(std::nextafter(5000.0, 1e4)));
  EXPECT_FALSE(bounds.Hold(std::nan("")));
  EXPECT_FALSE(bounds.Hold(std::numeric_limits<double>::infinity()));
}

// What the mathematics behind does with values: sums of 1e9 of their cubes, and their squares in a row of
// three.
TEST(ValueBounds, LeaveRoomForSumsOfCubes) {
  for (const char* name : {"time_s", "angle_deg", "angle_rad", "error_arcmin", "accel_m_per_s2", "speed_rpm",
                           "k_Nm_per_rad", "anything"}) {
    const double most = BoundsOf(name).most;
    EXPECT_TRUE(std::isfinite(1e9 * most * most * most)) << name;
  }
}

TEST(FindImplausible, NamesTheFirstValueOutOfBounds) {
  const ValueBounds& bounds = BoundsOf("torque_Nm");
  EXPECT_EQ(FindImplausible(std::array{1.0, -1e6, 1e6}, bounds), std::nullopt);
  EXPECT_EQ(FindImplausible(std::array{1.0, 1e200, -1e300}, bounds), 1U);
  EXPECT_EQ(FindImplausible(std::array{1.0, 2.0, std::nan("")}, bounds), 2U);
}

}  // namespace
}  // namespace strainwave::daq::value_bounds_test
