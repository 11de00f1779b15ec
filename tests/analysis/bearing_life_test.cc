// SPDX-License-Identifier: Apache-2.0
#include "analysis/bearing_life.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "tests/analysis/message_of.h"

namespace strainwave::analysis::bearing_life_test {
namespace {

constexpr double kCampaign_h = 1750.0;
const double kRatedSpeed = RadPerSFromRpm(2000.0);

double ConsumedBy(double torque_Nm, double speed_rpm) {
  const LoadBlock block{torque_Nm, RadPerSFromRpm(speed_rpm), SecondsFromHours(kCampaign_h)};
  return LifeConsumed({}, {&block, 1});
}

// The figures of docs/effects.md#bearing-life, rounded as there.
TEST(LifeConsumed, ReproducesTheWorkedExamples) {
  EXPECT_NEAR(ConsumedBy(34.0, 2000.0), 0.25, 1e-12);
  EXPECT_NEAR(ConsumedBy(54.0, 2000.0), 1.0, 0.01);
  EXPECT_NEAR(ConsumedBy(47.0, 3000.0), 1.0, 0.015);
  EXPECT_NEAR(LifeAtLoad_s({}, 54.0, kRatedSpeed), SecondsFromHours(kCampaign_h), SecondsFromHours(10.0));
}

TEST(LifeConsumed, AddsBlocksAsOneBlockAtTheCubicMean) {
  const std::vector<LoadBlock> blocks = {
      {40.0, RadPerSFromRpm(2400.0), 1800.0}, {-20.0, RadPerSFromRpm(-500.0), 600.0}, {0.0, 0.0, 300.0}};
  const LoadBlock mean{AverageTorque_Nm(blocks), AverageSpeed_rad_per_s(blocks), 2700.0};
  EXPECT_NEAR(LifeConsumed({}, blocks), LifeConsumed({}, {&mean, 1}), 1e-15);
  // By hand: ∛((2400·1800·40³ + 500·600·20³) / (2400·1800 + 500·600)).
  EXPECT_NEAR(mean.output_torque_Nm, std::cbrt((4.32e6 * 64000.0 + 0.3e6 * 8000.0) / 4.62e6), 1e-12);
}

TEST(LifeAtLoad, IsInfiniteAtRest) {
  EXPECT_TRUE(std::isinf(LifeAtLoad_s({}, 0.0, kRatedSpeed)));
  EXPECT_TRUE(std::isinf(LifeAtLoad_s({}, 34.0, 0.0)));
  EXPECT_EQ(AverageTorque_Nm({}), 0.0);
  EXPECT_EQ(AverageSpeed_rad_per_s({}), 0.0);
}

TEST(MarginsAtPeak, AreTheLimitsOverThePeak) {
  const OverloadMargins margins = MarginsAtPeak({}, -100.0);
  EXPECT_DOUBLE_EQ(margins.ratcheting, 3.5);
  EXPECT_DOUBLE_EQ(margins.buckling, 3.3);
}

TEST(BearingLife, RefusesWhatIsNoRatingOrNoBlock) {
  EXPECT_EQ(MessageOf([] { LifeAtLoad_s({.rated_torque_Nm = 0.0}, 1.0, 1.0); }),
            "rated_torque_Nm = 0 is not a positive number");
  const LoadBlock block{1.0, 1.0, -5.0};
  EXPECT_EQ(MessageOf([&] { LifeConsumed({}, {&block, 1}); }), "duration_s = -5 is not a number from 0 up");
}

}  // namespace
}  // namespace strainwave::analysis::bearing_life_test
