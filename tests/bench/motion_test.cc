// SPDX-License-Identifier: Apache-2.0
#include "bench/controller/motion.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "bench/controller/encoder_skew.h"

namespace strainwave::bench {
namespace {

TEST(Ramp, NeverExceedsItsRateAndEndsOnTheTarget) {
  Ramp ramp(10.0);
  double before = ramp.value();
  for (int i = 0; i < 100; ++i) {
    const double now = ramp.Step(4.7, 0.01);
    EXPECT_LE(std::abs(now - before), 0.1 + 1e-12);
    before = now;
  }
  EXPECT_EQ(ramp.value(), 4.7);
}

struct Move {
  double from, to, speed, acceleration;
};

class PointToPointTest : public testing::TestWithParam<Move> {};

// The profile is differentiated numerically, so that the closed form does not grade itself.
TEST_P(PointToPointTest, KeepsSpeedAndAccelerationAndRestsAtBothEnds) {
  const Move& m = GetParam();
  const PointToPoint move(m.from, m.to, m.speed, m.acceleration);
  const double step_s = move.duration_s() / 20000.0;
  EXPECT_NEAR(move.PositionAt(0.0), m.from, 1e-12);
  EXPECT_NEAR(move.PositionAt(move.duration_s()), m.to, 1e-9);
  EXPECT_EQ(move.PositionAt(move.duration_s() + 1.0), m.to);
  double top_speed = 0.0;
  double before_speed = 0.0;
  double top_acceleration = 0.0;
  for (int i = 1; i <= 20000; ++i) {
    const double speed = (move.PositionAt(i * step_s) - move.PositionAt((i - 1) * step_s)) / step_s;
    top_speed = std::max(top_speed, std::abs(speed));
    if (i > 1) top_acceleration = std::max(top_acceleration, std::abs(speed - before_speed) / step_s);
    before_speed = speed;
  }
  EXPECT_LE(top_speed, m.speed * (1.0 + 1e-6));
  EXPECT_LE(top_acceleration, m.acceleration * 1.01);
  EXPECT_NEAR(before_speed, 0.0, 2.0 * m.acceleration * step_s);
}

INSTANTIATE_TEST_SUITE_P(LongShortAndBackwards, PointToPointTest,
                         testing::Values(Move{0.0, 100.0, 10.0, 50.0}, Move{5.0, 5.3, 10.0, 50.0},
                                         Move{2.0, -40.0, 31.4, 1000.0}));

TEST(PointToPoint, OfNoDistanceTakesNoTime) {
  const PointToPoint move(3.0, 3.0, 10.0, 50.0);
  EXPECT_EQ(move.duration_s(), 0.0);
  EXPECT_EQ(move.PositionAt(0.0), 3.0);
}

TEST(ApproachSpeed, CanAlwaysStillBeBraked) {
  for (const double remaining : {-30.0, -0.1, 0.2, 7.0, 500.0}) {
    const double speed = ApproachSpeed(remaining, 100.0, 50.0);
    EXPECT_LE(speed * speed / (2.0 * 50.0), std::abs(remaining) * (1.0 + 1e-12));
    EXPECT_LE(std::abs(speed), 100.0);
    EXPECT_GT(speed * remaining, 0.0);
  }
}

// Steps of 80 degrees forth and back, as a sweep makes them; the twist goes with the torque, which goes with
// the direction, as a skew does.
TEST(EncoderSkew, IsToldFromTheTwistThatGoesWithTheDirection) {
  constexpr double kSkew_s = 1e-3;
  constexpr double kStiffness_Nm_per_rad = 15000.0;
  constexpr double kStep_rad = 80.0 * 3.14159265358979 / 180.0;
  EncoderSkew skew(80.0);
  double input_rad = 0.0;
  for (const double direction : {1.0, -1.0}) {
    for (int step = 0; step < 90; ++step) {
      const double from_rad = input_rad;
      for (int i = 1; i <= 20; ++i) {
        const double t = i / 20.0;
        Readings readings;
        readings.input_angle_rad = from_rad + direction * kStep_rad * t * t * (3.0 - 2.0 * t);
        readings.input_speed_rad_per_s = direction * kStep_rad * 6.0 * t * (1.0 - t) / 0.2;
        readings.output_torque_Nm = direction * (1.0 + 0.2 * std::cos(0.37 * step + i));
        const double kinematic_rad = 1.5e-4 * std::sin(2.0 * readings.input_angle_rad + 0.7);
        readings.output_angle_rad = readings.input_angle_rad / 80.0 - kinematic_rad -
                                    readings.output_torque_Nm / kStiffness_Nm_per_rad + 0.3 +
                                    kSkew_s * readings.input_speed_rad_per_s / 80.0;
        skew.Add(readings);
        input_rad = readings.input_angle_rad;
      }
      skew.EndMove();
    }
  }
  const auto estimate = skew.Estimate();
  ASSERT_TRUE(estimate.has_value());
  EXPECT_NEAR(estimate->skew_s, kSkew_s, 1e-9);
  EXPECT_LT(estimate->standard_error_s, 1e-8);
}

TEST(EncoderSkew, SaysNothingOfShaftsThatStand) {
  EncoderSkew skew(80.0);
  for (int i = 0; i < 100; ++i) {
    skew.Add({});
    skew.EndMove();
  }
  EXPECT_FALSE(skew.Estimate().has_value());
}

}  // namespace
}  // namespace strainwave::bench
