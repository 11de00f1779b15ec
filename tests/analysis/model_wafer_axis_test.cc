// SPDX-License-Identifier: Apache-2.0
#include "analysis/model/wafer_axis.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <gtest/gtest.h>

#include "tests/analysis/chance.h"

namespace strainwave::analysis::model::model_wafer_axis_test {
namespace {

WaferCycle Cycle(double worn_share, int damaged_teeth, std::uint64_t seed = 1) {
  WaferAxis axis;
  axis.worn_share = worn_share;
  axis.damaged_belt_teeth = damaged_teeth;
  return SimulateWaferCycle(axis, {}, {}, seed);
}

TEST(WaferAxis, GoesThereAndBack) {
  const WaferCycle cycle = Cycle(0.0, 0);
  ASSERT_EQ(cycle.current_A.size(), 2400U);
  ASSERT_EQ(cycle.velocity_rad_per_s.size(), 2400U);
  const double half_rad =
      std::accumulate(cycle.velocity_rad_per_s.begin(), cycle.velocity_rad_per_s.begin() + 1500, 0.0) /
      kWaferMotorRate_hz;
  const double all_rad =
      std::accumulate(cycle.velocity_rad_per_s.begin(), cycle.velocity_rad_per_s.end(), 0.0) /
      kWaferMotorRate_hz;
  // Noise of each sample, added up.
  const double error_rad =
      kByChance * WaferNoise{}.velocity_rad_per_s * std::sqrt(2400.0) / kWaferMotorRate_hz;
  EXPECT_NEAR(half_rad, 60.0, error_rad);
  EXPECT_NEAR(all_rad, 0.0, error_rad);
  EXPECT_EQ(std::ranges::count(cycle.state, 1.0), 998);
  EXPECT_FALSE(cycle.failed);
}

// At rest neither spring nor belt has a torque, and the current is the sensor's noise.
TEST(WaferAxis, RestsBetweenMoves) {
  const WaferCycle cycle = Cycle(0.0, 0);
  double squares = 0.0;
  for (std::size_t i = 0; i < 350; ++i) squares += cycle.current_A[i] * cycle.current_A[i] / 350.0;
  EXPECT_NEAR(std::sqrt(squares), WaferNoise{}.current_A,
              kByChance * SpreadOfDeviation(350.0) * WaferNoise{}.current_A);
}

TEST(WaferAxis, WornTeethAndBeltVibrateTheArm) {
  const double healthy = Cycle(0.0, 0).vertical_rms_m_per_s2;
  const double half = Cycle(1.0 / 6.0, 0).vertical_rms_m_per_s2;
  const double worn = Cycle(1.0 / 3.0, 0).vertical_rms_m_per_s2;
  EXPECT_GT(half, 1.5 * healthy);
  EXPECT_GT(worn, 1.3 * half);
  EXPECT_GT(Cycle(0.0, 21).vertical_rms_m_per_s2, 1.1 * healthy);
}

TEST(WaferAxis, OnlyBothAtTheirWorstFail) {
  EXPECT_FALSE(Cycle(1.0 / 3.0, 14).failed);
  EXPECT_FALSE(Cycle(1.0 / 6.0, 21).failed);
  EXPECT_TRUE(Cycle(1.0 / 3.0, 21).failed);
}

TEST(WaferAxis, SameSeedSameBits) {
  EXPECT_EQ(Cycle(0.1, 7, 5).current_A, Cycle(0.1, 7, 5).current_A);
  EXPECT_NE(Cycle(0.1, 7, 5).current_A, Cycle(0.1, 7, 6).current_A);
}

}  // namespace
}  // namespace strainwave::analysis::model::model_wafer_axis_test
