// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "analysis/units.h"
#include "tests/analysis/diagnosed.h"
#include "tests/analysis/led_axis.h"

namespace strainwave::analysis::diagnosis::diagnosis_motion_load_test {
namespace {

constexpr double kInertia_kgm2 = 0.01;
constexpr double kCoulomb_Nm = 2.4;
constexpr double kGravity_Nm = 0.08;
constexpr double kNoise_Nm = 0.05;

// A geared wrist: friction is more than all that it carries, so that the torque always has the motion's sign.
MotionData Wrist(unsigned seed, double gravity_Nm) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  MotionData record;
  const SinePath path{{1.4, kTwoPi * 0.13, 0.4}, {0.5, kTwoPi * 0.37, 2.1}, {0.2, kTwoPi * 0.83, 4.4}};
  for (int i = 0; i < 3000; ++i) {
    const double time_s = 0.01 * i;
    const auto [position_rad, speed_rad_per_s, acceleration_rad_per_s2] = StateOn(path, time_s);
    record.time_s.push_back(time_s);
    record.position.push_back(position_rad + 1e-6 * normal(random));
    record.torque.push_back(kInertia_kgm2 * acceleration_rad_per_s2 + 0.3 * speed_rad_per_s +
                            kCoulomb_Nm * std::tanh(speed_rad_per_s / 0.005) +
                            gravity_Nm * std::sin(position_rad + 0.9) + kNoise_Nm * normal(random));
  }
  return record;
}

TEST(MotionLoad, CallsGravityByItsNameWhereFrictionIsMoreThanTheLoad) {
  for (unsigned seed = 1; seed <= 4; ++seed) {
    SCOPED_TRACE(seed);
    const Diagnosed found = DiagnoseRecords(&MakeMotionStudy, {Wrist(seed, kGravity_Nm)});
    EXPECT_EQ(found.names(), Names{"gravity_load"});
  }
}

TEST(MotionLoad, SaysNothingOfAWristInBalance) {
  EXPECT_TRUE(DiagnoseRecords(&MakeMotionStudy, {Wrist(5, 0.0)}).names().empty());
}

}  // namespace
}  // namespace strainwave::analysis::diagnosis::diagnosis_motion_load_test
