// SPDX-License-Identifier: Apache-2.0
#include "analysis/efficiency.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/analysis/message_of.h"

namespace strainwave::analysis::efficiency_test {
namespace {

struct Rotation {
  std::vector<double> input_torque, input_speed, output_torque, output_speed;

  SteadyRotation View() const { return {input_torque, input_speed, output_torque, output_speed}; }
};

Rotation MakeRotation(double input_Nm, double input_rad_per_s, double output_Nm, double output_rad_per_s,
                      double noise = 0.0, std::uint32_t seed = 1) {
  std::mt19937 engine(seed);
  std::normal_distribution<double> normal;
  Rotation rotation;
  double state = 0.0;
  for (int i = 0; i < 400; ++i) {
    state = 0.5 * state + normal(engine);
    rotation.input_torque.push_back(input_Nm * (1.0 + noise * state));
    rotation.input_speed.push_back(input_rad_per_s);
    rotation.output_torque.push_back(output_Nm * (1.0 + noise * normal(engine)));
    rotation.output_speed.push_back(output_rad_per_s);
  }
  return rotation;
}

TEST(MeasureEfficiency, IsPowerOutOverPowerInOnWhicheverSideDrives) {
  // 0.6 Nm at 200 rad/s in, 30 Nm at 2.5 rad/s out: 75 W of 120 W.
  const Efficiency driven = MeasureEfficiency(MakeRotation(0.6, 200.0, 30.0, 2.5).View());
  EXPECT_NEAR(driven.efficiency.value, 75.0 / 120.0, 1e-12);
  EXPECT_FALSE(driven.back_driven);
  // The same with both shafts turning the other way.
  EXPECT_NEAR(MeasureEfficiency(MakeRotation(-0.6, -200.0, -30.0, -2.5).View()).efficiency.value, 0.625,
              1e-12);
  // The load drives: 75 W in at the output, 40 W out at the input.
  const Efficiency back = MeasureEfficiency(MakeRotation(-0.2, 200.0, -30.0, 2.5).View());
  EXPECT_TRUE(back.back_driven);
  EXPECT_NEAR(back.efficiency.value, 40.0 / 75.0, 1e-12);
}

TEST(MeasureEfficiency, ItsErrorCoversTheTruth) {
  int held = 0;
  constexpr int kTrials = 300;
  for (std::uint32_t seed = 1; seed <= kTrials; ++seed) {
    const Estimate value =
        MeasureEfficiency(MakeRotation(0.6, 200.0, 30.0, 2.5, 0.1, seed).View()).efficiency;
    held += std::abs(value.value - 0.625) < 1.96 * value.standard_error ? 1 : 0;
  }
  EXPECT_GE(held, 0.90 * kTrials);
  EXPECT_LE(held, 0.99 * kTrials);
}

TEST(MeasureEfficiency, SaysWhenTheSignsCannotBe) {
  using Checks = std::vector<std::string>;
  EXPECT_EQ(MeasureEfficiency(MakeRotation(0.6, 200.0, -30.0, 2.5).View()).failed_checks,
            Checks{"power flows into the gear on both sides: a sign is swapped"});
  EXPECT_EQ(MeasureEfficiency(MakeRotation(-0.6, 200.0, 30.0, 2.5).View()).failed_checks,
            Checks{"power flows out of the gear on both sides: a sign is swapped"});
  EXPECT_EQ(MeasureEfficiency(MakeRotation(0.3, 200.0, 30.0, 2.5).View()).failed_checks,
            Checks{"more power comes out than goes in: efficiency 1.25"});
}

TEST(MeasureStartingTorque, IsWhereTheSpeedLeavesZeroForGood) {
  std::vector<double> torque_Nm;
  std::vector<double> speed_rad_per_s;
  for (int i = 0; i < 200; ++i) {
    torque_Nm.push_back(0.001 * i);
    speed_rad_per_s.push_back(i >= 120 ? -0.5 * (i - 119) : 0.001 * (i % 2));
  }
  speed_rad_per_s[60] = 3.0;  // one reading alone is no motion
  const auto start = MeasureStartingTorque(torque_Nm, speed_rad_per_s, 0.1);
  ASSERT_TRUE(start);
  EXPECT_NEAR(start->value, 0.1195, 1e-12);
  EXPECT_NEAR(start->standard_error, 0.0005, 1e-6);
  EXPECT_FALSE(
      MeasureStartingTorque(std::span(torque_Nm).first(100), std::span(speed_rad_per_s).first(100), 0.1));
}

TEST(Efficiency, RefusesBadArguments) {
  const std::vector<double> few(5, 1.0);
  EXPECT_EQ(MessageOf([&] {
              MeasureEfficiency({few, few, few, few});
            }),
            "input_torque_Nm has 5 values (expected at least 8)");
  const std::vector<double> eight(8, 1.0);
  EXPECT_EQ(MessageOf([&] { MeasureStartingTorque(eight, eight, 0.0); }),
            "speed_threshold_rad_per_s = 0 is not a positive number");
}

}  // namespace
}  // namespace strainwave::analysis::efficiency_test
