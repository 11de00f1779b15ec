// SPDX-License-Identifier: Apache-2.0
#include "bench/controller/motion.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

namespace strainwave::bench::motion_test {
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

}  // namespace
}  // namespace strainwave::bench::motion_test
