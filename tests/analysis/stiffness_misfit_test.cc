// SPDX-License-Identifier: Apache-2.0
// Loops that one spring and one friction element do not describe: made by small steps (generated_loop.h).
#include <gtest/gtest.h>

#include <cmath>

#include "analysis/torsional_stiffness.h"
#include "tests/analysis/generated_loop.h"

namespace strainwave::analysis::stiffness_misfit_test {
namespace {

using diagnosis::GeneratedGear;
using diagnosis::GeneratedSensors;
using Warnings = std::vector<std::string>;

constexpr TestTorques kTorques{.t1_Nm = 7.0, .t2_Nm = 25.0, .t3_Nm = 34.0};

TorsionalStiffness Measure(const GeneratedGear& gear, double noise_Nm, std::uint32_t seed,
                           const TestTorques& torques = kTorques, double peak_Nm = 34.0) {
  const GeneratedSensors sensors{.torque_noise_Nm = noise_Nm, .angle_noise_rad = 3e-7};
  std::vector<diagnosis::PathLeg> path = diagnosis::Loops(1, {{peak_Nm, 1.0, 0.0}});
  path.push_back({0.0, 1.0, 0.0});
  const diagnosis::HysteresisData record = GenerateLoop(gear, sensors, path, 1500, seed);
  return MeasureStiffness({record.time_s, record.torque_Nm, record.output_angle_rad}, torques,
                          StiffnessMethod::kModel);
}

GeneratedGear WithFriction(std::vector<double> friction_Nm, std::vector<double> yield_rad) {
  GeneratedGear gear;
  gear.friction_Nm = std::move(friction_Nm);
  gear.yield_rad = std::move(yield_rad);
  return gear;
}

// Two errors hold the truth, which the errors of the noise alone, of some Nm/rad, do not by far.
TEST(MisfitOfForm, IsInTheErrorsWhereFrictionYieldsInSteps) {
  const GeneratedGear gears[] = {WithFriction({0.4, 0.4, 0.5}, {7e-5, 2.2e-4, 5e-4}),
                                 WithFriction({0.6, 0.3, 0.3}, {1e-4, 3e-4, 6e-4}),
                                 WithFriction({0.3, 0.2, 0.4}, {4e-5, 1.6e-4, 5e-4})};
  std::uint32_t seed = 0;
  for (const GeneratedGear& gear : gears) {
    const TorsionalStiffness fit = Measure(gear, 0.03, ++seed);
    const Estimate slopes[] = {fit.k1_Nm_per_rad, fit.k2_Nm_per_rad, fit.k3_Nm_per_rad};
    const double truths[] = {gear.k1_Nm_per_rad, gear.k2_Nm_per_rad, gear.k3_Nm_per_rad};
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_NEAR(slopes[k].value, truths[k], 2.0 * slopes[k].standard_error) << "K" << k + 1;
      EXPECT_LT(slopes[k].standard_error, 0.1 * truths[k]) << "K" << k + 1;
    }
    EXPECT_FALSE(fit.warnings.empty());
    EXPECT_EQ(fit.failed_checks, Warnings());
  }
}

TEST(MisfitOfForm, IsNoneOfALoopOfOneElement) {
  for (std::uint32_t seed = 1; seed <= 10; ++seed) {
    const TorsionalStiffness fit = Measure(WithFriction({1.2}, {1e-4}), 0.03, seed);
    EXPECT_EQ(fit.warnings, Warnings()) << seed;
    EXPECT_EQ(fit.failed_checks, Warnings()) << seed;
    EXPECT_LT(fit.k3_Nm_per_rad.standard_error, 1e-3 * fit.k3_Nm_per_rad.value) << seed;
  }
}

TEST(MisfitOfForm, FailsACheckWhereTheKneesAreThoseOfAnotherGear) {
  GeneratedGear larger = WithFriction({1.5}, {8e-5});
  larger.k1_Nm_per_rad = 3.0e4;
  larger.k2_Nm_per_rad = 4.8e4;
  larger.k3_Nm_per_rad = 5.6e4;
  larger.t1_Nm = 14.0;
  larger.t2_Nm = 48.0;
  const TorsionalStiffness fit = Measure(larger, 0.03, 3, kTorques, 90.0);
  ASSERT_EQ(fit.failed_checks.size(), 1U);
  EXPECT_TRUE(fit.failed_checks[0].starts_with("the model leaves 0.")) << fit.failed_checks[0];
  EXPECT_TRUE(fit.failed_checks[0].ends_with(
      "(expected at most 8 times that: are t1 = 7 and t2 = 25 Nm the knees of this gear?)"))
      << fit.failed_checks[0];
  const TorsionalStiffness right =
      Measure(larger, 0.03, 3, {.t1_Nm = 14.0, .t2_Nm = 48.0, .t3_Nm = 90.0}, 90.0);
  EXPECT_EQ(right.failed_checks, Warnings());
}

// More than the noise may be, and yet a form of friction.
TEST(MisfitOfForm, FailsNoCheckWhereFrictionIsASpectrum) {
  const TorsionalStiffness fit =
      Measure(WithFriction({0.5, 0.5, 0.5, 0.5}, {6e-5, 1.5e-4, 3e-4, 6e-4}), 0.005, 4);
  EXPECT_GT(fit.rms_residual_Nm, 8.0 * fit.noise_Nm);
  EXPECT_EQ(fit.failed_checks, Warnings());
}

}  // namespace
}  // namespace strainwave::analysis::stiffness_misfit_test
