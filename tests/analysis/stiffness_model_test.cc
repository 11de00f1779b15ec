// SPDX-License-Identifier: Apache-2.0
#include "analysis/torsional_stiffness.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "tests/analysis/simulated_loop.h"

namespace strainwave::analysis::stiffness_model_test {
namespace {

constexpr TestTorques kTorques{.t1_Nm = 7.0, .t2_Nm = 25.0, .t3_Nm = 34.0};
// From rest, from the middle of a stroke, several loops, with minor loops.
const std::vector<std::vector<double>> kPaths_Nm = {
    {0, 34, -34, 0},        {0, -34, 34, 0},
    {-34, 34, -34},         {0, 34, -34, 34, -34, 34, -34, 0},
    {-20, 34, -34, 34, 10}, {0, 34, 20, 34, -34, -10, -20, 5, -34, 0}};

void ExpectSlopesWithin(const TorsionalStiffness& fit, const LoopTruth& truth, double relative) {
  EXPECT_NEAR(fit.k1_Nm_per_rad.value, truth.k1_Nm_per_rad, relative * truth.k1_Nm_per_rad);
  EXPECT_NEAR(fit.k2_Nm_per_rad.value, truth.k2_Nm_per_rad, relative * truth.k2_Nm_per_rad);
  EXPECT_NEAR(fit.k3_Nm_per_rad.value, truth.k3_Nm_per_rad, relative * truth.k3_Nm_per_rad);
}

TEST(FitStiffnessModel, RecoversANoiseFreeLoopOnEveryPath) {
  constexpr double kExact = 1e-6;
  for (const auto& path_Nm : kPaths_Nm) {
    const LoopTruth truth;
    const SimulatedRecord record = SimulateLoop(truth, path_Nm, 3000);
    const TorsionalStiffness fit = FitStiffnessModel(record.View(), kTorques);
    ExpectSlopesWithin(fit, truth, kExact);
    EXPECT_NEAR(fit.friction_torque_Nm, truth.friction_Nm, 1e-6);
    EXPECT_NEAR(fit.yield_twist_rad, truth.yield_rad, 1e-6 * truth.yield_rad);
    EXPECT_LT(fit.rms_residual_Nm, 1e-6);
    EXPECT_EQ(fit.failed_checks, std::vector<std::string>{});
  }
}

TEST(FitStiffnessModel, RecoversGearsFarFromTheTypicalOne) {
  const LoopTruth gears[] = {{.k1_Nm_per_rad = 0.8e4, .k2_Nm_per_rad = 1.1e4, .k3_Nm_per_rad = 2.0e4},
                             {.k1_Nm_per_rad = 3.0e4, .k2_Nm_per_rad = 2.0e4, .k3_Nm_per_rad = 1.5e4},
                             {.friction_Nm = 0.1, .yield_rad = RadFromArcsec(20.0)},
                             {.friction_Nm = 3.0, .yield_rad = RadFromArcsec(60.0)},
                             {.friction_Nm = 0.6, .yield_rad = RadFromArcsec(2.0)}};
  for (const LoopTruth& truth : gears) {
    const SimulatedRecord record = SimulateLoop(truth, {0, 34, -34, 0}, 4000);
    ExpectSlopesWithin(FitStiffnessModel(record.View(), kTorques), truth, 1e-6);
  }
}

TEST(FitStiffnessModel, HoldsThreePerMilleUnderTypicalNoise) {
  const LoopTruth truth;
  for (std::uint32_t seed = 1; seed <= 10; ++seed) {
    const LoopNoise noise{
        .torque_Nm = 0.02, .twist_rad = RadFromArcsec(0.2), .autoregression = 0.0, .seed = seed};
    const SimulatedRecord record = SimulateLoop(truth, {0, 34, -34, 0}, 3000, noise);
    const TorsionalStiffness fit = FitStiffnessModel(record.View(), kTorques);
    ExpectSlopesWithin(fit, truth, 0.003);
    EXPECT_EQ(fit.failed_checks, std::vector<std::string>{});
  }
}

// Noise in the signal that goes into the model is not seen by least squares. 5 arcsec are a sixth of the
// yield twist; the raw twist would ratchet the element and bend the knees.
TEST(FitStiffnessModel, IsNotBiasedByNoiseInEitherChannel) {
  const LoopTruth truth;
  const LoopNoise kinds[] = {{.torque_Nm = 0.3, .twist_rad = 0.0},
                             {.torque_Nm = 0.0, .twist_rad = RadFromArcsec(5.0)}};
  for (LoopNoise noise : kinds) {
    constexpr int kRecords = 24;
    double mean[3] = {};
    double square[3] = {};
    for (std::uint32_t seed = 1; seed <= kRecords; ++seed) {
      noise.seed = seed;
      const SimulatedRecord record = SimulateLoop(truth, {0, 34, -34, 0}, 2000, noise);
      const TorsionalStiffness fit = FitStiffnessModel(record.View(), kTorques);
      const double off[3] = {fit.k1_Nm_per_rad.value / truth.k1_Nm_per_rad - 1.0,
                             fit.k2_Nm_per_rad.value / truth.k2_Nm_per_rad - 1.0,
                             fit.k3_Nm_per_rad.value / truth.k3_Nm_per_rad - 1.0};
      for (int k = 0; k < 3; ++k) {
        mean[k] += off[k] / kRecords;
        square[k] += off[k] * off[k] / kRecords;
      }
    }
    for (int k = 0; k < 3; ++k) {
      const double deviation = std::sqrt(square[k] - mean[k] * mean[k]);
      EXPECT_LT(std::abs(mean[k]), 3.5 * deviation / std::sqrt(kRecords)) << "K" << k + 1;
      EXPECT_LT(std::abs(mean[k]), 0.01) << "K" << k + 1;
    }
  }
}

TEST(FitStiffnessModel, TakesQuantisedSignals) {
  const LoopTruth truth;
  SimulatedRecord record = SimulateLoop(truth, {0, 34, -34, 0}, 3000);
  const double arcsec = RadFromArcsec(1.0);
  for (std::size_t i = 0; i < record.torque_Nm.size(); ++i) {
    record.twist_rad[i] = std::round(record.twist_rad[i] / arcsec) * arcsec;
    record.torque_Nm[i] = std::round(record.torque_Nm[i] / 0.02) * 0.02;
  }
  const TorsionalStiffness fit = FitStiffnessModel(record.View(), kTorques);
  ExpectSlopesWithin(fit, truth, 0.003);
  EXPECT_EQ(fit.failed_checks, std::vector<std::string>{});
}

TEST(FitStiffnessModel, IsNotMovedByOutliers) {
  const LoopTruth truth;
  const LoopNoise noise{.torque_Nm = 0.02, .twist_rad = RadFromArcsec(0.2)};
  SimulatedRecord record = SimulateLoop(truth, {0, 34, -34, 0}, 3000, noise);
  const TorsionalStiffness clean = FitStiffnessModel(record.View(), kTorques);
  std::mt19937 engine(5);
  for (std::size_t i = 7; i < record.torque_Nm.size(); i += 61) {
    record.torque_Nm[i] += static_cast<double>(engine() % 100) * 0.1 - 2.0;
    record.twist_rad[i + 20] -= RadFromArcsec(static_cast<double>(engine() % 100));
  }
  for (std::size_t i = 1400; i < 1412; ++i) {
    record.torque_Nm[i] += 3.0;  // a segment, too long for the filter of single spikes
  }
  const TorsionalStiffness fit = FitStiffnessModel(record.View(), kTorques);
  // Half a standard error or so, against several per cent without weights.
  EXPECT_NEAR(fit.k1_Nm_per_rad.value, clean.k1_Nm_per_rad.value, 2.0 * clean.k1_Nm_per_rad.standard_error);
  EXPECT_NEAR(fit.k2_Nm_per_rad.value, clean.k2_Nm_per_rad.value, 2.0 * clean.k2_Nm_per_rad.standard_error);
  EXPECT_NEAR(fit.k3_Nm_per_rad.value, clean.k3_Nm_per_rad.value, 2.0 * clean.k3_Nm_per_rad.standard_error);
}

TEST(FitStiffnessModel, FindsTheSpringWhereThereIsNoFriction) {
  const LoopTruth truth{.friction_Nm = 0.0};
  for (const double torque_noise_Nm : {0.0, 0.02}) {
    const SimulatedRecord record = SimulateLoop(truth, {0, 34, -34, 0}, 3000, {.torque_Nm = torque_noise_Nm});
    const TorsionalStiffness fit = FitStiffnessModel(record.View(), kTorques);
    ExpectSlopesWithin(fit, truth, 0.001);
    EXPECT_EQ(fit.friction_torque_Nm, 0.0);
    EXPECT_EQ(fit.yield_twist_rad, 0.0);
    // A straight spring's own error at that noise, about 1e-4 of K1: no share of it goes to friction that is
    // not there.
    EXPECT_LT(fit.k1_Nm_per_rad.standard_error, 3e-4 * truth.k1_Nm_per_rad);
    EXPECT_EQ(fit.failed_checks, std::vector<std::string>{});
  }
}

TEST(FitStiffnessModel, DoesNotDependOnTheTwistsZero) {
  SimulatedRecord record = SimulateLoop({}, {0, 34, -34, 0}, 2000);
  for (double& twist_rad : record.twist_rad) {
    twist_rad += 1.0;
  }
  ExpectSlopesWithin(FitStiffnessModel(record.View(), kTorques), {}, 1e-6);
}

TEST(FitStiffnessModel, GivesTheSameBitsTwice) {
  const SimulatedRecord record =
      SimulateLoop({}, {0, 34, -34, 0}, 2000, {.torque_Nm = 0.02, .twist_rad = RadFromArcsec(0.2)});
  const TorsionalStiffness first = FitStiffnessModel(record.View(), kTorques);
  const TorsionalStiffness second = FitStiffnessModel(record.View(), kTorques);
  EXPECT_EQ(first.k3_Nm_per_rad.value, second.k3_Nm_per_rad.value);
  EXPECT_EQ(first.k3_Nm_per_rad.standard_error, second.k3_Nm_per_rad.standard_error);
  EXPECT_EQ(first.fitted_torque_Nm, second.fitted_torque_Nm);
}

TEST(FitStiffnessModel, ReturnsTheLoopItFitted) {
  constexpr double kNoise_Nm = 0.05;
  const SimulatedRecord record = SimulateLoop({}, {0, 34, -34, 0}, 1000, {.torque_Nm = kNoise_Nm});
  const TorsionalStiffness fit = FitStiffnessModel(record.View(), kTorques);
  const SimulatedRecord clean = SimulateLoop({}, {0, 34, -34, 0}, 1000);
  ASSERT_EQ(fit.fitted_torque_Nm.size(), clean.torque_Nm.size());
  for (std::size_t i = 0; i < clean.torque_Nm.size(); ++i) {
    // A fit of some ten parameters to 1000 samples: √(10 / 1000) of the noise, and more where few samples
    // carry one of them.
    EXPECT_NEAR(fit.fitted_torque_Nm[i], clean.torque_Nm[i], 0.5 * kNoise_Nm);
  }
}

}  // namespace
}  // namespace strainwave::analysis::stiffness_model_test
