// SPDX-License-Identifier: Apache-2.0
// Numbers that the records leave open are not given, and what they have in common is.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "analysis/diagnosis/fit_covariance.h"
#include "analysis/units.h"
#include "tests/analysis/diagnosed.h"
#include "tests/analysis/diagnosed_loop.h"

namespace strainwave::analysis::diagnosis::diagnosis_open_numbers_test {
namespace {

bool IsOpen(const ParameterValue& number) { return std::isinf(number.standard_error); }

// Seconds of an axis of 0.03 kg m², 0.2 Nms/rad, 0.9 Nm of friction and 0.35 Nm of offset that never turns
// round.
MotionData OneWay(unsigned seed, double way) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  MotionData record;
  for (int i = 0; i < 3000; ++i) {
    const double time_s = 0.004 * i;
    const double speed = 7.0 + 3.0 * std::sin(1.3 * time_s) + 2.0 * std::sin(3.1 * time_s);
    const double acceleration = 3.9 * std::cos(1.3 * time_s) + 6.2 * std::cos(3.1 * time_s);
    const double position =
        7.0 * time_s - 3.0 / 1.3 * std::cos(1.3 * time_s) - 2.0 / 3.1 * std::cos(3.1 * time_s);
    record.time_s.push_back(time_s);
    record.position.push_back(way * position + 1e-7 * normal(random));
    record.torque.push_back(way * (0.03 * acceleration + 0.2 * speed + 0.9) + 0.35 + 0.04 * normal(random));
  }
  return record;
}

TEST(OpenNumbers, OfAnAxisThatTurnsOneWayAreFrictionAndOffset) {
  const Diagnosed one = DiagnoseRecords(&MakeMotionStudy, std::vector{OneWay(1, 1.0)});
  EXPECT_TRUE(IsOpen(one.nominal("coulomb_Nm")));
  EXPECT_TRUE(IsOpen(one.nominal("offset_Nm")));
  EXPECT_NEAR(one.nominal("inertia_kgm2").value, 0.03, 0.001);
  EXPECT_NEAR(one.nominal("viscous_Nms_per_rad").value, 0.2, 0.005);
  ASSERT_EQ(one.diagnosis.open.size(), 1U);
  EXPECT_TRUE(one.diagnosis.open[0].starts_with(
      "the records do not tell coulomb_Nm from offset_Nm: known is coulomb_Nm + offset_Nm = 1.25"))
      << one.diagnosis.open[0];
}

TEST(OpenNumbers, OfAnAxisThatTurnsBackwardsHaveADifference) {
  const Diagnosed one = DiagnoseRecords(&MakeMotionStudy, std::vector{OneWay(2, -1.0)});
  ASSERT_EQ(one.diagnosis.open.size(), 1U);
  EXPECT_TRUE(one.diagnosis.open[0].starts_with(
      "the records do not tell coulomb_Nm from offset_Nm: known is coulomb_Nm - offset_Nm = 0.55"))
      << one.diagnosis.open[0];
}

TEST(OpenNumbers, OfRecordsWithAnOffsetEachStayOpenWhereEachTurnsOneWay) {
  const Diagnosed two = DiagnoseRecords(&MakeMotionStudy, std::vector{OneWay(3, 1.0), OneWay(4, -1.0)});
  for (const char* name : {"coulomb_Nm", "offset_Nm", "offset_2_Nm"}) EXPECT_TRUE(IsOpen(two.nominal(name)));
  EXPECT_EQ(two.diagnosis.open,
            Names{"the records do not tell apart, or say nothing of: coulomb_Nm, offset_Nm, offset_2_Nm"});
}

// With 1.2 Nm of friction the spring's own torque ends below the second knee at 25 Nm, though the loop goes
// to 25.8.
TEST(OpenNumbers, OfALoopThatStopsShortOfAKneeAreItsSlope) {
  const GeneratedGear gear;
  const Diagnosed loop = DiagnoseLoop(gear, {}, Loops(2, {{25.8, 2.0, 0.0}}), 3000, 5);
  EXPECT_TRUE(IsOpen(loop.nominal("k3_Nm_per_rad")));
  EXPECT_NEAR(loop.nominal("k2_Nm_per_rad").value, gear.k2_Nm_per_rad, 0.005 * gear.k2_Nm_per_rad);
  EXPECT_EQ(loop.diagnosis.open, Names{"the records say nothing of k3_Nm_per_rad"});
}

TransmissionErrorData SweepOf(double ratio, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  TransmissionErrorData record;
  record.ratio = ratio;
  record.absolute = true;
  for (const int way : {1, -1}) {
    for (int i = 0; i <= 360; ++i) {
      const double output = RadFromDeg(way > 0 ? i : 360 - i);
      const double error = RadFromArcmin(0.7 * std::cos(2.0 * ratio * output - 0.8) + 0.2 * std::cos(output));
      record.direction.push_back(way);
      record.input_angle_rad.push_back(ratio * (output + error));
      record.output_angle_rad.push_back(output + RadFromArcmin(0.01) * normal(random));
    }
  }
  return record;
}

TEST(OpenNumbers, OfASweepAreAHarmonicAtHalfItsSteps) {
  const Diagnosed sweep = DiagnoseRecords(&MakeTransmissionErrorStudy, std::vector{SweepOf(90.0, 6)});
  EXPECT_TRUE(IsOpen(sweep.nominal("second_harmonic_amplitude_arcmin")));
  EXPECT_FALSE(IsOpen(sweep.nominal("offset_arcmin")));
  EXPECT_EQ(sweep.names(), Names{"output_eccentricity"});
  EXPECT_EQ(
      sweep.study->warnings().front(),
      "the second harmonic of the wave generator is not known: order 180 is half of 360 samples a turn: how "
      "much is seen hangs on its phase");
}

TEST(OpenNumbers, OfASweepAreAHarmonicThatStandsStillFromStepToStepAndTheOffset) {
  const Diagnosed sweep = DiagnoseRecords(&MakeTransmissionErrorStudy, std::vector{SweepOf(180.0, 7)});
  EXPECT_TRUE(IsOpen(sweep.nominal("second_harmonic_amplitude_arcmin")));
  EXPECT_TRUE(IsOpen(sweep.nominal("offset_arcmin")));
  // Its columns follow the error itself, 360 times a turn, and take the eccentricity up.
  for (const std::string& name : sweep.names()) EXPECT_EQ(name, "output_eccentricity");
}

TEST(OpenNumbers, AreNoneWhereTheStepsSeeEverything) {
  const Diagnosed sweep = DiagnoseRecords(&MakeTransmissionErrorStudy, std::vector{SweepOf(80.0, 8)});
  EXPECT_NEAR(sweep.nominal("second_harmonic_amplitude_arcmin").value, 0.7, 0.005);
  EXPECT_EQ(sweep.diagnosis.open, Names());
}

TEST(ErrorsOfFit, GivesTheDirectionThatNoSampleKnows) {
  // y = a + b x + c (2 + 3 x): c may grow by one where a falls by two and b by three.
  constexpr Eigen::Index kSamples = 50;
  Eigen::MatrixXd columns(kSamples, 3);
  std::vector<double> measured;
  for (Eigen::Index i = 0; i < kSamples; ++i) {
    const double x = 0.1 * static_cast<double>(i);
    columns.row(i) << 1.0, x, 2.0 + 3.0 * x;
    measured.push_back(std::sin(7.0 * x));
  }
  const std::vector<double> weights(kSamples, 1.0);
  const std::vector<std::size_t> segments{0};
  const FitErrors errors = ErrorsOfFit(columns, measured, Eigen::VectorXd::Zero(kSamples), weights, segments,
                                       0, Eigen::VectorXd::Zero(3));
  ASSERT_EQ(errors.open.cols(), 1);
  EXPECT_NEAR(errors.open(0, 0) / errors.open(2, 0), -2.0, 1e-6);
  EXPECT_NEAR(errors.open(1, 0) / errors.open(2, 0), -3.0, 1e-6);
  const FitErrors held = ErrorsOfFit(columns, measured, Eigen::VectorXd::Zero(kSamples), weights, segments, 0,
                                     Eigen::VectorXd::Ones(3));
  EXPECT_EQ(held.open.cols(), 0);
}

}  // namespace
}  // namespace strainwave::analysis::diagnosis::diagnosis_open_numbers_test
