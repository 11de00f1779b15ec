// SPDX-License-Identifier: Apache-2.0
#include "bench/controller/encoder_skew.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <gtest/gtest.h>

#include "analysis/units.h"

namespace strainwave::bench::encoder_skew_test {
namespace {

constexpr double kRatio = 80.0;
constexpr double kMove_s = 0.24;
constexpr double kStep_rad = kRatio * kTwoPi / 36.0;

// Angle of a move from rest to rest, and its derivatives by time.
struct Motion {
  double angle_rad, speed_rad_per_s, acceleration_rad_per_s2;
};
Motion MotionAt(double time_s) {
  const double t = std::clamp(time_s / kMove_s, 0.0, 1.0);
  return {kStep_rad * t * t * t * (10.0 - 15.0 * t + 6.0 * t * t),
          kStep_rad / kMove_s * 30.0 * t * t * (1.0 - t) * (1.0 - t),
          kStep_rad / (kMove_s * kMove_s) * 60.0 * t * (1.0 - t) * (1.0 - 2.0 * t)};
}

// A sweep of one turn forth and back. Its twist goes by direction, as a skew does; the output swings on the
// spring, so that it is faster than the input tells; and the drive tells its speed 5 ms late.
EncoderSkew AfterASweep(double skew_s, int times_each = 1) {
  constexpr double kCompliance_rad_per_Nm = 8e-5;
  constexpr double kInertia_kgm2 = 0.12;
  constexpr double kDrag_Nm = 1.0;
  constexpr double kLostMotion_rad = 1e-4;
  EncoderSkew skew(kRatio);
  double from_rad = 0.0;
  std::chrono::nanoseconds now{};
  for (const double direction : {1.0, -1.0}) {
    for (int step = 0; step < 36; ++step) {
      skew.BeginMove(direction);
      const auto output_at = [&](double time_s) {
        const Motion motion = MotionAt(time_s);
        const double input_rad = from_rad + direction * motion.angle_rad;
        const double torque_Nm = direction * (kDrag_Nm * motion.speed_rad_per_s / 40.0 +
                                              kInertia_kgm2 * motion.acceleration_rad_per_s2 / kRatio);
        return std::pair(input_rad / kRatio - 1.5e-4 * std::sin(2.0 * input_rad + 0.7) -
                             kCompliance_rad_per_Nm * torque_Nm - kLostMotion_rad * direction + 0.3,
                         torque_Nm);
      };
      for (int i = 0; i < 75; ++i, now += std::chrono::milliseconds(4)) {
        const double time_s = 4e-3 * i;
        AlignedSample sample;
        sample.time = now;
        sample.input_angle_rad = from_rad + direction * MotionAt(time_s).angle_rad;
        sample.input_speed_rad_per_s = direction * MotionAt(time_s - 5e-3).speed_rad_per_s;
        sample.output_angle_rad = output_at(time_s + skew_s).first;
        sample.output_torque_Nm = output_at(time_s).second;
        for (int time = 0; time < times_each; ++time) skew.Add(sample);
      }
      from_rad += direction * kStep_rad;
    }
  }
  return skew;
}

TEST(EncoderSkew, IsToldFromTwistLostMotionAndSwing) {
  for (const double skew_s : {1e-3, -1e-3, 1e-4, 0.0}) {
    const auto estimate = AfterASweep(skew_s).Estimate();
    ASSERT_TRUE(estimate.has_value());
    EXPECT_NEAR(estimate->skew_s, skew_s, 10e-6) << "docs/effects.md E20";
    EXPECT_LT(estimate->standard_error_s, 10e-6);
  }
}

// A control loop may be faster than what it reads.
TEST(EncoderSkew, TakesNoReadingTwice) {
  const auto once = AfterASweep(1e-3).Estimate();
  const auto twice = AfterASweep(1e-3, 2).Estimate();
  ASSERT_TRUE(twice.has_value());
  EXPECT_EQ(twice->skew_s, once->skew_s);
  EXPECT_EQ(twice->standard_error_s, once->standard_error_s);
}

TEST(EncoderSkew, SaysNothingOfShaftsThatStand) {
  EncoderSkew skew(kRatio);
  for (int i = 0; i < 100; ++i) {
    skew.BeginMove(i % 2 == 0 ? 1.0 : -1.0);
    for (int k = 0; k < 3; ++k) {
      AlignedSample sample;
      sample.time = std::chrono::milliseconds(10 * i + k);
      skew.Add(sample);
    }
  }
  EXPECT_FALSE(skew.Estimate().has_value());
}

}  // namespace
}  // namespace strainwave::bench::encoder_skew_test
