// SPDX-License-Identifier: Apache-2.0
#include "analysis/mean_over_angle.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "analysis/transmission_error.h"
#include "analysis/units.h"
#include "tests/analysis/chance.h"

namespace strainwave::analysis::mean_over_angle_test {
namespace {

HarmonicFit Unfitted(std::vector<double> values) {
  HarmonicFit fit;
  fit.residuals = std::move(values);
  return fit;
}

// A turn in steps of 3.35 deg, in a part of it in a quarter of that, as rows come in time of a sweep that is
// slow there; rows from `gap_deg` on are missing for 14 deg.
std::vector<double> UnevenTurn_rad(double slow_from_deg, double gap_deg) {
  std::vector<double> angle_rad;
  for (double angle_deg = 0.0;
       angle_deg<358.0; angle_deg += angle_deg> slow_from_deg && angle_deg < slow_from_deg + 110.0 ? 0.8375
                                                                                                   : 3.35) {
    if (angle_deg < gap_deg || angle_deg > gap_deg + 14.0) angle_rad.push_back(RadFromDeg(angle_deg));
  }
  return angle_rad;
}

constexpr double kNever_deg = 1000.0;
constexpr double kRatio = 100.0;
constexpr double kLevel_arcmin = -0.62;

// Two waves a turn of the input, and one a turn of the output.
AngleSweep Swept(const std::vector<double>& output_rad, double level_arcmin, std::uint32_t seed,
                 std::vector<double>* input_rad) {
  constexpr double kNoise_arcmin = 0.003;
  std::mt19937 engine(seed);
  std::normal_distribution<double> normal;
  for (const double angle_rad : output_rad) {
    const double error_arcmin = level_arcmin + 0.71 * std::cos(2.0 * kRatio * angle_rad - 0.4) +
                                0.45 * std::cos(angle_rad - 1.0) + kNoise_arcmin * normal(engine);
    input_rad->push_back(kRatio * (angle_rad + RadFromArcmin(error_arcmin)));
  }
  return {*input_rad, output_rad};
}

TEST(MeanOverAngle, IsRightWhereTheStepsAreUnevenAndRowsAreMissing) {
  constexpr int kSweeps = 400;
  int held = 0;
  for (std::uint32_t seed = 1; seed <= kSweeps; ++seed) {
    const std::vector<double> output_rad = UnevenTurn_rad(120.0, 60.0 + 0.5 * seed);
    std::vector<double> input_rad;
    const AngleSweep sweep = Swept(output_rad, kLevel_arcmin, seed, &input_rad);
    const TransmissionError result = ComputeTransmissionError(sweep, {}, kRatio);
    ASSERT_TRUE(result.cw);
    // The angles are those of the record as they stand, not zeroed at the first.
    const Estimate mean = result.cw->e_avg_rad;
    EXPECT_NEAR(ArcminFromRad(mean.value), kLevel_arcmin, 0.005) << seed;  // the trapezoid rule: up to 0.05
    held += std::abs(mean.value - RadFromArcmin(kLevel_arcmin)) < 1.96 * mean.standard_error ? 1 : 0;
  }
  ExpectCoverageOf95(held, kSweeps);
}

TEST(MeanOverAngle, OfEvenStepsIsTheMeanOfTheSamples) {
  std::vector<double> angle_rad;
  std::vector<double> values;
  std::mt19937 engine(3);
  std::normal_distribution<double> normal;
  double sum = 0.0;
  for (int i = 0; i < 360; ++i) {
    angle_rad.push_back(RadFromDeg(i));
    values.push_back(3.0 + std::cos(2.0 * angle_rad.back()) + normal(engine));
    sum += values.back();
  }
  const HarmonicFit fit = FitHarmonics(angle_rad, values, std::vector{2.0}, ErrorModel::kIndependent);
  EXPECT_NEAR(MeanOverAngle({angle_rad, fit}).value, sum / 360.0, 1e-12);
}

// Steps that are off by what the error itself moves the output: sine and cosine of the wave are nearly one.
TEST(MeanOverAngle, OfTwoSamplesAPeriodIsTheMeanOfTheSamples) {
  std::vector<double> input_rad;
  std::vector<double> output_rad;
  for (int i = 0; i <= 72; ++i) {
    input_rad.push_back(RadFromDeg(80.0 * 5.0 * i));
    output_rad.push_back(RadFromDeg(5.0 * i - (i % 2 == 0 ? 0.0 : 0.01)));
  }
  const TransmissionError result = ComputeTransmissionError({input_rad, output_rad}, {}, 80.0);
  ASSERT_TRUE(result.cw);
  EXPECT_NEAR(ArcminFromRad(result.cw->e_avg_rad.value), 0.3, 1e-6);
}

TEST(MeanOverAngle, CountsAnOrderThatIsNoWholeNumberByItsIntegral) {
  std::vector<double> angle_rad;
  std::vector<double> values;
  constexpr double kOrder = 2.5;
  for (int i = 0; i < 360; ++i) {
    angle_rad.push_back(RadFromDeg(i));
    values.push_back(std::sin(kOrder * angle_rad.back()));
  }
  const HarmonicFit fit = FitHarmonics(angle_rad, values, std::vector{kOrder}, ErrorModel::kIndependent);
  const double integral = (1.0 - std::cos(kOrder * kTwoPi)) / kOrder;
  EXPECT_NEAR(MeanOverAngle({angle_rad, fit}).value, integral / kTwoPi, 1e-12);
}

TEST(MeanDifferenceAtEqualAngle, IsRightWhereTheStepsAreUneven) {
  const std::vector<double> there_rad = UnevenTurn_rad(150.0, kNever_deg);
  std::vector<double> back_rad = UnevenTurn_rad(140.0, kNever_deg);
  for (double& angle_rad : back_rad) angle_rad = kTwoPi - angle_rad;
  std::vector<double> input_there_rad;
  std::vector<double> input_back_rad;
  const AngleSweep cw = Swept(there_rad, 0.0, 1, &input_there_rad);
  const AngleSweep ccw = Swept(back_rad, 0.25, 2, &input_back_rad);
  const TransmissionError result = ComputeTransmissionError(cw, ccw, kRatio);
  ASSERT_TRUE(result.lost_motion_rad);
  EXPECT_NEAR(ArcminFromRad(result.lost_motion_rad->value), -0.25, 0.003);
}

TEST(MeanDifferenceAtEqualAngle, InterpolatesBetweenOffsetGrids) {
  // Half a turn of a steep straight error: what is read beside the angle does not average out.
  std::vector<double> first_rad;
  std::vector<double> second_rad;
  HarmonicFit first;
  HarmonicFit second;
  for (int i = 0; i < 180; ++i) {
    first_rad.push_back(RadFromDeg(i));
    first.residuals.push_back(3.0 * first_rad.back() + 0.5);
    second_rad.push_back(RadFromDeg(i + 0.3));
    second.residuals.push_back(3.0 * second_rad.back());
  }
  EXPECT_NEAR(MeanDifferenceAtEqualAngle({first_rad, first}, {second_rad, second}).value(), 0.5, 1e-12);
}

TEST(MeanDifferenceAtEqualAngle, IsNoneWithoutACommonAngle) {
  std::vector<double> first_rad;
  std::vector<double> second_rad;
  for (int i = 0; i < 90; ++i) {
    first_rad.push_back(RadFromDeg(i));
    second_rad.push_back(RadFromDeg(180 + i));
  }
  const HarmonicFit zero = Unfitted(std::vector<double>(90));
  EXPECT_FALSE(MeanDifferenceAtEqualAngle({first_rad, zero}, {second_rad, zero}));
}

}  // namespace
}  // namespace strainwave::analysis::mean_over_angle_test
