// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "analysis/noise_level.h"
#include "analysis/units.h"
#include "tests/analysis/diagnosed.h"
#include "tests/analysis/diagnosed_loop.h"
#include "tests/analysis/generated_loop.h"

namespace strainwave::analysis::diagnosis::diagnosis_loop_rates_test {
namespace {

// A ramp of three times the torque's noise a sample, which has one rate: what is left of the noise is none.
TEST(RateDependence, IsNoneOfTheTorquesNoise) {
  const std::vector<PathLeg> path{{34.0, 7.2}, {-34.0, 7.2}, {0.0, 7.2}};
  for (std::uint32_t seed = 1; seed <= 12; ++seed) {
    const Diagnosed clean = DiagnoseLoop(
        {}, {.torque_noise_Nm = 0.02, .angle_noise_rad = RadFromArcmin(0.003)}, path, 2400, seed);
    EXPECT_EQ(clean.names(), Names()) << seed;
  }
}

// Three loops, each three times as fast as the one before.
Diagnosed AskAtThreeRates(const GeneratedGear& gear) {
  std::vector<PathLeg> path;
  for (const double rate_Nm_per_s : {0.5, 1.5, 4.5}) {
    for (const double to_Nm : {34.0, -34.0, 0.0}) path.push_back({to_Nm, rate_Nm_per_s});
  }
  return DiagnoseLoop(gear, {.angle_noise_rad = RadFromArcmin(0.02)}, path, 4000, 3);
}

TEST(RateDependence, OfFrictionInProportionIsNotAnotherCauseBesideIt) {
  const Diagnosed answer = AskAtThreeRates({.linear_rise_with_rate = 0.06});
  ASSERT_EQ(answer.names(), Names{"rate_dependence"});
  const double per_rate =
      answer.value("linear_friction_rise_share").value / answer.value("usual_rate_Nm_per_s").value;
  EXPECT_NEAR(per_rate, 0.06, 0.012);
}

TEST(RateDependence, OfTheTorqueThatIsFeltIsNotAnotherCauseBesideIt) {
  const Diagnosed answer = AskAtThreeRates({.torque_lag_s = 0.15});
  ASSERT_EQ(answer.names(), Names{"rate_dependence"});
  const ParameterValue lag = answer.value("torque_lag_s");
  EXPECT_NEAR(lag.value, 0.15, 4.0 * lag.standard_error);
  EXPECT_LT(lag.standard_error, 0.02);
}

// Where noise of the torque is all there is, the twist's goes with the gear's compliance.
TEST(HysteresisWeights, AreThoseOfTheTorquesNoise) {
  const std::vector<PathLeg> path{{34.0, 1.0}, {-34.0, 1.0}, {34.0, 1.0}};
  const auto above_over_below = [&](double torque_noise_Nm, double angle_noise_rad) {
    const HysteresisData record = GenerateLoop(
        {}, {.torque_noise_Nm = torque_noise_Nm, .angle_noise_rad = angle_noise_rad}, path, 6000, 4);
    const auto study = MakeHysteresisStudy(std::vector<HysteresisData>{record});
    const std::span<const double> weights = study->Weights();
    double sum = 0.0;
    std::vector<double> below;
    std::vector<double> above;
    for (std::size_t i = 0; i < weights.size(); ++i) {
      sum += weights[i];
      const double torque_Nm = std::abs(record.torque_Nm[i]);
      if (torque_Nm < 5.0) below.push_back(weights[i]);
      if (torque_Nm > 27.0) above.push_back(weights[i]);
    }
    EXPECT_NEAR(sum / static_cast<double>(weights.size()), 1.0, 1e-9);
    return Median(above) / Median(below);
  };
  EXPECT_NEAR(above_over_below(0.05, RadFromArcmin(1e-4)), 4.0, 0.6);  // (K3 / K1)²
  EXPECT_NEAR(above_over_below(0.001, RadFromArcmin(0.05)), 1.0, 0.05);
}

// Changes of equal size are no steps of an encoder, whose rounding would hide the jump.
TEST(HysteresisSteps, AreNotThoseOfAnEvenRamp) {
  HysteresisData record = GenerateLoop({}, {.torque_noise_Nm = 0.02, .angle_noise_rad = RadFromArcmin(5e-4)},
                                       {{34.0, 1.0}, {-34.0, 1.0}, {34.0, 1.0}}, 700, 3);
  // The same torque over a twist that goes on by equal amounts, and turns between two of them.
  const double step_rad = RadFromArcmin(0.1017);
  for (std::size_t i = 0; i < record.output_angle_rad.size(); ++i) {
    const double quarter = static_cast<double>(i) / 139.8;
    const double share = quarter < 1.0 ? quarter : quarter < 3.0 ? 2.0 - quarter : quarter - 4.0;
    record.output_angle_rad[i] =
        139.8 * step_rad * share + 1e-3 * step_rad * std::sin(static_cast<double>(i * i));
  }
  EXPECT_EQ(MakeHysteresisStudy(std::vector<HysteresisData>{record})->Rounding(), 0.0);
}

// Locked at another angle of the input a gear is softer by some percent.
TEST(HysteresisRecords, OfDifferentStiffnessAreTold) {
  const std::vector<PathLeg> path{{34.0, 1.0}, {-34.0, 1.0}, {34.0, 1.0}};
  const auto warnings = [&](double times) {
    const HysteresisData first = GenerateLoop({}, {}, path, 3000, 1);
    const HysteresisData second = GenerateLoop(
        {.k1_Nm_per_rad = 1.5e4 * times, .k2_Nm_per_rad = 2.4e4 * times, .k3_Nm_per_rad = 3.0e4 * times}, {},
        path, 3000, 2);
    return MakeHysteresisStudy(std::vector<HysteresisData>{first, second})->warnings();
  };
  EXPECT_EQ(warnings(1.0), std::vector<std::string>{});
  const std::vector<std::string> told = warnings(0.94);
  ASSERT_EQ(told.size(), 1U);
  EXPECT_TRUE(told[0].starts_with("the records differ in stiffness, K2 from 22")) << told[0];
}

}  // namespace
}  // namespace strainwave::analysis::diagnosis::diagnosis_loop_rates_test
