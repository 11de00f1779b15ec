// SPDX-License-Identifier: Apache-2.0
#include "analysis/torsional_stiffness.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/analysis/message_of.h"
#include "tests/analysis/simulated_loop.h"

namespace strainwave::analysis::torsional_stiffness_test {
namespace {

constexpr TestTorques kTorques{.t1_Nm = 7.0, .t2_Nm = 25.0, .t3_Nm = 34.0};
const std::vector<double> kFromRest_Nm = {0, 34, -34, 0};
const std::vector<double> kFromPeak_Nm = {-34, 34, -34};
using Checks = std::vector<std::string>;

TEST(FitStiffnessLoading, IsTheSecantsOfTheFirstLoadingFromRest) {
  const LoopTruth truth;
  const SimulatedRecord record = SimulateLoop(truth, kFromRest_Nm, 7000);
  const TorsionalStiffness fit = FitStiffnessLoading(record.View(), kTorques);
  // By hand: with friction wound up the spring carries T − W, and its breaks are seen W later.
  const double w = truth.friction_Nm;
  const double twist1 = (7.0 - w) / truth.k1_Nm_per_rad;
  const double twist2 = 7.0 / truth.k1_Nm_per_rad + (18.0 - w) / truth.k2_Nm_per_rad;
  const double twist3 =
      7.0 / truth.k1_Nm_per_rad + 18.0 / truth.k2_Nm_per_rad + (9.0 - w) / truth.k3_Nm_per_rad;
  constexpr double kReading = 2e-3;  // the start is read by a line over the first winding-up samples
  EXPECT_NEAR(fit.k1_Nm_per_rad.value, 7.0 / twist1, kReading * 7.0 / twist1);
  EXPECT_NEAR(fit.k2_Nm_per_rad.value, 18.0 / (twist2 - twist1), 1e-6 * fit.k2_Nm_per_rad.value);
  EXPECT_NEAR(fit.k3_Nm_per_rad.value, 9.0 / (twist3 - twist2), 1e-6 * fit.k3_Nm_per_rad.value);
  EXPECT_EQ(fit.failed_checks, Checks{});
}

TEST(FitStiffnessLoading, TakesTheNegativeSideWhereThePositiveOneIsNotLoaded) {
  const SimulatedRecord record = SimulateLoop({}, {0, -34, 0}, 3000);
  const TorsionalStiffness fit = FitStiffnessLoading(record.View(), kTorques);
  EXPECT_NEAR(fit.k2_Nm_per_rad.value, 18.0 / (0.6 / 1.6e4 + 17.4 / 2.5e4), 1.0);
  EXPECT_EQ(fit.failed_checks.at(0), "torque not reached: 0 Nm at most (expected at least 98 % of 34 Nm)");
}

TEST(FitStiffnessBackbone, RecoversANoiseFreeLoop) {
  const LoopTruth truth;
  for (const auto& path_Nm : {kFromRest_Nm, kFromPeak_Nm}) {
    const SimulatedRecord record = SimulateLoop(truth, path_Nm, 3000);
    const TorsionalStiffness fit = FitStiffnessBackbone(record.View(), kTorques);
    EXPECT_NEAR(fit.k1_Nm_per_rad.value, truth.k1_Nm_per_rad, 1e-6 * truth.k1_Nm_per_rad);
    EXPECT_NEAR(fit.k2_Nm_per_rad.value, truth.k2_Nm_per_rad, 1e-6 * truth.k2_Nm_per_rad);
    EXPECT_NEAR(fit.k3_Nm_per_rad.value, truth.k3_Nm_per_rad, 1e-6 * truth.k3_Nm_per_rad);
    EXPECT_NEAR(fit.friction_torque_Nm, truth.friction_Nm, 1e-6);
    EXPECT_EQ(fit.failed_checks, Checks{});
  }
}

TEST(MeasureStiffness, MeasuresTheWidthOfTheLoopWithEveryMethod) {
  const LoopTruth truth;
  const SimulatedRecord record = SimulateLoop(truth, kFromRest_Nm, 7000);
  for (const auto method : {StiffnessMethod::kModel, StiffnessMethod::kLoading, StiffnessMethod::kBackbone}) {
    const TorsionalStiffness fit = MeasureStiffness(record.View(), kTorques, method);
    // At zero torque the spring holds what the sliding element pushes: ±W.
    EXPECT_NEAR(fit.hysteresis_rad.value, 2.0 * truth.friction_Nm / truth.k1_Nm_per_rad, 1e-9);
    EXPECT_NEAR(fit.lost_motion_rad.value, 2.0 * 0.04 * 34.0 / truth.k1_Nm_per_rad, 1e-9);
  }
  TestTorques rated = kTorques;
  rated.rated_Nm = 40.0;
  EXPECT_NEAR(FitStiffnessLoading(record.View(), rated).lost_motion_rad.value,
              2.0 * 0.04 * 40.0 / truth.k1_Nm_per_rad, 1e-9);
}

TEST(MeasureStiffness, TakesTheBenchesComplianceOut) {
  const LoopTruth truth;
  const double compliance = 1.0 / 4e4 + 1.0 / 3e4;  // docs/effects.md E17: more than the gear's own
  const SimulatedRecord record = SimulateLoop(truth, kFromRest_Nm, 3000, {}, compliance);
  const TorsionalStiffness raw = MeasureStiffness(record.View(), kTorques, StiffnessMethod::kModel);
  EXPECT_LT(raw.k3_Nm_per_rad.value, 1.3e4);
  for (const auto method : {StiffnessMethod::kModel, StiffnessMethod::kBackbone}) {
    const TorsionalStiffness gear = MeasureStiffness(record.View(), kTorques, method, {{compliance, 0.0}});
    EXPECT_NEAR(gear.k1_Nm_per_rad.value, truth.k1_Nm_per_rad, 1e-6 * truth.k1_Nm_per_rad);
    EXPECT_NEAR(gear.k2_Nm_per_rad.value, truth.k2_Nm_per_rad, 1e-6 * truth.k2_Nm_per_rad);
    EXPECT_NEAR(gear.k3_Nm_per_rad.value, truth.k3_Nm_per_rad, 1e-6 * truth.k3_Nm_per_rad);
  }
}

TEST(MeasureStiffness, CombinesTheErrorsOfComplianceAndTransducer) {
  const LoopTruth truth;
  const double compliance = 1e-5;
  const double error = 2e-8;
  const SimulatedRecord record = SimulateLoop(truth, kFromRest_Nm, 3000, {}, compliance);
  const TorsionalStiffness fit =
      MeasureStiffness(record.View(), kTorques, StiffnessMethod::kModel, {{compliance, error}}, 0.003);
  // 1/K = 1/K_measured − C, so that dK = K² dC; the record itself is free of noise.
  for (const auto& [slope, value] :
       {std::pair{fit.k1_Nm_per_rad, truth.k1_Nm_per_rad}, std::pair{fit.k2_Nm_per_rad, truth.k2_Nm_per_rad},
        std::pair{fit.k3_Nm_per_rad, truth.k3_Nm_per_rad}}) {
    const double expected = std::hypot(value * value * error, 0.003 * value);
    EXPECT_NEAR(slope.standard_error, expected, 0.02 * expected);
  }
}

TEST(StiffnessChecks, NameATorqueThatIsNotReached) {
  const SimulatedRecord record = SimulateLoop({}, {0, 30, -34, 0}, 2000);
  EXPECT_EQ(FitStiffnessModel(record.View(), kTorques).failed_checks,
            Checks{"torque not reached: 30 Nm at most (expected at least 98 % of 34 Nm)"});
}

TEST(StiffnessChecks, NameASegmentThatIsNotThere) {
  const SimulatedRecord record = SimulateLoop({}, {0, 20, -20, 0}, 2000);
  const TorsionalStiffness fit = FitStiffnessModel(record.View(), kTorques);
  EXPECT_TRUE(std::isnan(fit.k3_Nm_per_rad.value));
  EXPECT_NEAR(fit.k1_Nm_per_rad.value, 1.6e4, 1.0);
  EXPECT_EQ(fit.failed_checks,
            (Checks{"torque not reached: 20 Nm at most (expected at least 98 % of 34 Nm)",
                    "torque not reached: -20 Nm at least (expected at most 98 % of -34 Nm)",
                    "too few samples: 0 between 25 and 34 Nm (expected at least 8)",
                    "stiffness K3 is not in the record"}));
}

TEST(StiffnessChecks, NameALoopThatDoesNotClose) {
  SimulatedRecord record = SimulateLoop({}, kFromRest_Nm, 2000);
  for (std::size_t i = 300; i < record.twist_rad.size(); ++i) {
    record.twist_rad[i] += RadFromArcmin(0.5);  // the brake slipped
  }
  const TorsionalStiffness fit = FitStiffnessLoading(record.View(), kTorques);
  ASSERT_EQ(fit.failed_checks.size(), 1U);
  // The slip less the 0.129′ that the first sample lies above the returning branch.
  EXPECT_EQ(fit.failed_checks[0].substr(0, 79),
            "loop not closed: the twist ends 0.372 arcmin from where it was at -0.136 Nm (ex");
}

TEST(LoopWidth, IsNotKnownBetterThanTheStepsOfTheAngle) {
  constexpr double kStep_arcmin = 1.318;  // 14 bits of a turn; the loop is 0.26 arcmin wide
  SimulatedRecord record = SimulateLoop({}, kFromRest_Nm, 2000);
  for (double& twist_rad : record.twist_rad)
    twist_rad = RadFromArcmin(kStep_arcmin * std::round(ArcminFromRad(twist_rad) / kStep_arcmin));
  const TorsionalStiffness fit = FitStiffnessModel(record.View(), kTorques);
  EXPECT_GE(ArcminFromRad(fit.hysteresis_rad.standard_error), 0.999 * kStep_arcmin * std::sqrt(2.0 / 12.0));
  EXPECT_GE(ArcminFromRad(fit.lost_motion_rad.standard_error), 0.999 * kStep_arcmin / std::sqrt(12.0));
}

// The first loading from rest crosses zero torque half a loop's width from where the loop does.
TEST(StiffnessChecks, NameAGapAtZeroTorqueOnTheWayBack) {
  SimulatedRecord record = SimulateLoop({}, kFromRest_Nm, 2000);
  std::size_t lowest = 0;
  for (std::size_t i = 0; i < record.torque_Nm.size(); ++i) {
    if (record.torque_Nm[i] < record.torque_Nm[lowest]) lowest = i;
  }
  SimulatedRecord gap;
  for (std::size_t i = 0; i < record.torque_Nm.size(); ++i) {
    if (i > lowest && record.torque_Nm[i] > -4.0 && record.torque_Nm[i] < 10.0) continue;
    gap.torque_Nm.push_back(record.torque_Nm[i]);
    gap.twist_rad.push_back(record.twist_rad[i]);
  }
  const TorsionalStiffness fit = FitStiffnessLoading(gap.View(), kTorques);
  EXPECT_TRUE(std::isnan(fit.hysteresis_rad.value));
  ASSERT_GE(fit.failed_checks.size(), 1U);
  EXPECT_EQ(fit.failed_checks[0],
            "no loop at zero torque: the record lacks a loading or an unloading branch there");
}

TEST(StiffnessChecks, NameARampThatNeverComesBack) {
  const SimulatedRecord record = SimulateLoop({}, {-34, 34}, 2000);
  const TorsionalStiffness fit = FitStiffnessLoading(record.View(), kTorques);
  EXPECT_EQ(fit.failed_checks,
            (Checks{"no loop at zero torque: the record lacks a loading or an unloading branch there",
                    "loop not closed: torque goes from -33.9 to 33.9 Nm and never comes back"}));
}

TEST(StiffnessChecks, NameASwappedSign) {
  SimulatedRecord record = SimulateLoop({}, kFromRest_Nm, 2000);
  for (double& twist_rad : record.twist_rad) {
    twist_rad = -twist_rad;
  }
  for (const auto method : {StiffnessMethod::kModel, StiffnessMethod::kLoading, StiffnessMethod::kBackbone}) {
    const TorsionalStiffness fit = MeasureStiffness(record.View(), kTorques, method);
    ASSERT_EQ(fit.failed_checks.size(), 4U);
    EXPECT_EQ(fit.failed_checks[0], "twist falls with torque: a sign is swapped");
    EXPECT_EQ(fit.failed_checks[2].substr(0, 31), "stiffness not positive: K2 = -2");
  }
}

TEST(StiffnessArguments, AreRefusedByName) {
  const SimulatedRecord record = SimulateLoop({}, kFromRest_Nm, 200);
  const TorsionLoop loop = record.View();
  EXPECT_EQ(MessageOf([&] {
              FitStiffnessModel({loop.time_s, loop.torque_Nm.first(100), loop.twist_rad}, kTorques);
            }),
            "torque_Nm has 100 values, twist_rad has 201 (expected the same number)");
  EXPECT_EQ(MessageOf([&] {
              FitStiffnessModel({loop.time_s.first(15), loop.torque_Nm.first(15), loop.twist_rad.first(15)},
                                kTorques);
            }),
            "torque_Nm has 15 values (expected at least 16)");
  EXPECT_EQ(MessageOf([&] {
              FitStiffnessLoading(loop, {25.0, 7.0, 34.0});
            }),
            "t1_Nm = 25, t2_Nm = 7, t3_Nm = 34 are out of order (expected 0 < t1 < t2 < t3)");
  std::vector<double> broken = record.twist_rad;
  broken[17] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(MessageOf([&] {
              FitStiffnessBackbone({loop.time_s, loop.torque_Nm, broken}, kTorques);
            }),
            "twist_rad[17] = nan is not finite");
  EXPECT_EQ(MessageOf([&] {
              MeasureStiffness(loop, kTorques, StiffnessMethod::kModel, {{-1e-6, 0.0}});
            }),
            "compliance_rad_per_Nm = -1e-06 is not a number from 0 up");
  EXPECT_EQ(MessageOf([&] { MeasureStiffness(loop, kTorques, StiffnessMethod::kModel, {}, -0.1); }),
            "torque_gain_relative_se = -0.1 is not a number from 0 up");
}

}  // namespace
}  // namespace strainwave::analysis::torsional_stiffness_test
