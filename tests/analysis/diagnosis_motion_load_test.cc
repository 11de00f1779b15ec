// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "analysis/units.h"
#include "tests/analysis/diagnosed.h"

namespace strainwave::analysis::diagnosis {
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
  constexpr double kTones[][3] = {{0.13, 1.4, 0.4}, {0.37, 0.5, 2.1}, {0.83, 0.2, 4.4}};
  for (int i = 0; i < 3000; ++i) {
    const double time_s = 0.01 * i;
    double position_rad = 0.0;
    double speed_rad_per_s = 0.0;
    double acceleration_rad_per_s2 = 0.0;
    for (const auto& [frequency_Hz, amplitude_rad, phase_rad] : kTones) {
      const double omega = kTwoPi * frequency_Hz;
      position_rad += amplitude_rad * std::sin(omega * time_s + phase_rad);
      speed_rad_per_s += amplitude_rad * omega * std::cos(omega * time_s + phase_rad);
      acceleration_rad_per_s2 -= amplitude_rad * omega * omega * std::sin(omega * time_s + phase_rad);
    }
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
}  // namespace strainwave::analysis::diagnosis
