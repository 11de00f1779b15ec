// SPDX-License-Identifier: Apache-2.0
#include "analysis/transmission_error.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "analysis/units.h"
#include "tests/analysis/chance.h"
#include "tests/analysis/message_of.h"

namespace strainwave::analysis::transmission_error_test {
namespace {

constexpr double kRatio = 80.0;
using Checks = std::vector<std::string>;

struct Sweep {
  std::vector<double> input_rad;
  std::vector<double> output_rad;

  AngleSweep View() const { return {input_rad, output_rad}; }
};

struct Line {
  double order;
  double amplitude_arcsec;
  double phase_rad;
};

struct SweepPlan {
  double from_deg = 0.0;
  double step_deg = 1.0;
  int samples = 361;
  double offset_arcsec = 0.0;
  double noise_arcsec = 0.0;
  std::uint32_t seed = 1;
  bool zeroed = false;
  double ratio = kRatio;
};

double TrueError(const std::vector<Line>& lines, double output_rad) {
  double error_rad = 0.0;
  for (const Line& line : lines) {
    error_rad += RadFromArcsec(line.amplitude_arcsec) * std::cos(line.order * output_rad - line.phase_rad);
  }
  return error_rad;
}

Sweep MakeSweep(const std::vector<Line>& lines, const SweepPlan& plan) {
  std::mt19937 engine(plan.seed);
  std::normal_distribution<double> normal;
  Sweep sweep;
  for (int i = 0; i < plan.samples; ++i) {
    const double output_rad = RadFromDeg(plan.from_deg + plan.step_deg * i);
    const double error_rad = TrueError(lines, output_rad) + RadFromArcsec(plan.offset_arcsec) +
                             RadFromArcsec(plan.noise_arcsec) * normal(engine);
    sweep.output_rad.push_back(output_rad);
    sweep.input_rad.push_back(plan.ratio * (output_rad + error_rad));
  }
  if (plan.zeroed) {
    const double first_input_rad = sweep.input_rad.front();
    for (double& input_rad : sweep.input_rad) {
      input_rad -= first_input_rad;
    }
  }
  return sweep;
}

const std::vector<Line> kGear = {{1, 10, 0.3}, {80, 6, 1.0}, {160, 20, -0.4}, {162, 8, 2.0}, {320, 3, 0.9}};

TEST(ComputeTransmissionError, TakesMeanAndRangeOverOneRevolutionOfTheOutput) {
  const Sweep sweep = MakeSweep(kGear, {.offset_arcsec = 5.0});
  const TransmissionError result = ComputeTransmissionError(sweep.View(), {}, kRatio);
  double mean_rad = 0.0;
  double low_rad = 1e9;
  double high_rad = -1e9;
  for (int i = 0; i < 360; ++i) {  // the 361st sample is the first one of the next revolution
    const double error_rad = TrueError(kGear, RadFromDeg(i)) + RadFromArcsec(5.0);
    mean_rad += error_rad / 360.0;
    low_rad = std::min(low_rad, error_rad);
    high_rad = std::max(high_rad, error_rad);
  }
  ASSERT_TRUE(result.cw);
  EXPECT_EQ(result.cw->error_rad.size(), 360U);
  EXPECT_NEAR(result.cw->e_avg_rad.value, mean_rad, 1e-13);
  EXPECT_NEAR(result.cw->e_max_rad.value, high_rad - low_rad, 1e-13);
  EXPECT_FALSE(result.ccw);
  EXPECT_FALSE(result.lost_motion_rad);
  EXPECT_EQ(result.failed_checks, Checks{});
}

TEST(ComputeTransmissionError, UsesTheFirstRevolutionOfALongerSweep) {
  const Sweep one = MakeSweep(kGear, {});
  Sweep long_one = MakeSweep(kGear, {.samples = 800});
  long_one.input_rad[500] += 1.0;
  const auto expected = ComputeTransmissionError(one.View(), {}, kRatio);
  const auto result = ComputeTransmissionError(long_one.View(), {}, kRatio);
  EXPECT_EQ(result.cw->e_max_rad.value, expected.cw->e_max_rad.value);
  EXPECT_EQ(result.cw->error_rad.size(), 360U);
}

TEST(ComputeTransmissionError, TakesASignedRatioAndAFallingSweep) {
  Sweep sweep = MakeSweep(kGear, {.step_deg = -1.0, .ratio = -80.0});
  const TransmissionError result = ComputeTransmissionError({}, sweep.View(), -80.0);
  EXPECT_EQ(result.failed_checks, Checks{});
  EXPECT_EQ(result.ccw->error_rad.size(), 360U);
  EXPECT_NEAR(result.ccw->error_rad[7], TrueError(kGear, RadFromDeg(-7)), 1e-13);
}

TEST(ComputeTransmissionError, NamesTheOrdersAndTheFoldedOne) {
  const Sweep sweep = MakeSweep(kGear, {});
  const TransmissionError result = ComputeTransmissionError(sweep.View(), {}, kRatio);
  const auto find = [&](double order) {
    return *std::find_if(result.cw->orders.begin(), result.cw->orders.end(),
                         [&](const OrderLine& line) { return line.order_per_output_rev == order; });
  };
  for (const Line& line : kGear) {
    EXPECT_NEAR(ArcsecFromRad(find(line.order).amplitude_rad.value), line.amplitude_arcsec, 1e-6)
        << line.order;
  }
  EXPECT_EQ(result.cw->orders.front().name, "wave generator, 2nd harmonic");
  EXPECT_EQ(find(162).name, "tooth engagement");
  EXPECT_DOUBLE_EQ(find(162).order_per_input_rev, 2.025);
  EXPECT_FALSE(find(160).aliased);
  EXPECT_TRUE(find(320).aliased);
  EXPECT_EQ(find(320).name, "wave generator, 4th harmonic");
  EXPECT_NEAR(find(320).alias_order_per_output_rev, 40.0, 1e-9);
  EXPECT_EQ(
      result.notes,
      Checks{"order 320 (wave generator, 4th harmonic) appears at order 40: 360 samples per output turn"});
}

TEST(ComputeTransmissionError, SaysWhichOrdersTheSamplingCannotTellApart) {
  // 240 samples: 80 stays, 160 appears at 80, 162 at 78, 320 at 80.
  const Sweep sweep = MakeSweep({{80, 6, 1.0}}, {.step_deg = 1.5, .samples = 240});
  const TransmissionError result = ComputeTransmissionError(sweep.View(), {}, kRatio);
  EXPECT_EQ(
      result.notes,
      (Checks{
          "order 160 (wave generator, 2nd harmonic) appears at order 80: 240 samples per output turn",
          "orders 80 (wave generator, 1st harmonic) and 160 (wave generator, 2nd harmonic) appear at one "
          "order, 80",
          "order 162 (tooth engagement) appears at order 78: 240 samples per output turn",
          "order 320 (wave generator, 4th harmonic) appears at order 80: 240 samples per output turn",
          "orders 80 (wave generator, 1st harmonic or wave generator, 2nd harmonic) and 320 (wave generator, "
          "4th harmonic) appear at one order, 80"}));
  EXPECT_EQ(result.cw->orders.front().name,
            "wave generator, 1st harmonic or wave generator, 2nd harmonic or wave generator, 4th harmonic");
}

TEST(ComputeTransmissionError, FindsALineThatNobodyExpected) {
  const Sweep sweep = MakeSweep({{160, 20, 0.0}, {23, 4, 0.0}}, {.noise_arcsec = 1.0});
  const TransmissionError result = ComputeTransmissionError(sweep.View(), {}, kRatio);
  EXPECT_EQ(result.cw->orders[1].order_per_output_rev, 23.0);
  EXPECT_EQ(result.cw->orders[1].name, "");
  // From 360 samples less what the lines and the mean take.
  EXPECT_NEAR(ArcsecFromRad(result.cw->noise_rad), 1.0, kByChance * SpreadOfDeviation(340.0));
}

TEST(ComputeTransmissionError, ItsStandardErrorsCoverTheTruth) {
  constexpr int kTrials = 300;
  for (const bool zeroed : {false, true}) {
    const Sweep clean = MakeSweep(kGear, {.zeroed = zeroed});
    const TransmissionError truth = ComputeTransmissionError(clean.View(), {}, kRatio);
    int mean_held = 0;
    double bias_rad = 0.0;
    double expected_bias_rad = 0.0;
    double square = 0.0;
    double error_square = 0.0;
    for (std::uint32_t seed = 1; seed <= kTrials; ++seed) {
      const Sweep sweep = MakeSweep(kGear, {.noise_arcsec = 1.5, .seed = seed, .zeroed = zeroed});
      const TransmissionError result = ComputeTransmissionError(sweep.View(), {}, kRatio);
      const Estimate& mean = result.cw->e_avg_rad;
      mean_held += std::abs(mean.value - truth.cw->e_avg_rad.value) < 1.96 * mean.standard_error ? 1 : 0;
      const double off_rad = result.cw->e_max_rad.value - truth.cw->e_max_rad.value;
      bias_rad += off_rad / kTrials;
      expected_bias_rad += result.cw->e_max_noise_bias_rad / kTrials;
      square += off_rad * off_rad / kTrials;
      error_square += std::pow(result.cw->e_max_rad.standard_error, 2) / kTrials;
    }
    ExpectCoverageOf95(mean_held, kTrials);
    const double deviation_rad = std::sqrt(square);
    EXPECT_NEAR(bias_rad, expected_bias_rad, kByChance * deviation_rad / std::sqrt(kTrials));
    EXPECT_NEAR(std::sqrt(error_square) / deviation_rad, 1.0, kByChance * SpreadOfDeviation(kTrials));
  }
}

// Both sweeps of a record have one zero, the first sample of the sweep that came first.
TEST(ComputeTransmissionError, HasTheNoiseOfTheCommonZeroInTheMeansOfBothSweeps) {
  constexpr int kTrials = 300;
  int held = 0;
  for (std::uint32_t seed = 1; seed <= kTrials; ++seed) {
    Sweep cw = MakeSweep(kGear, {.noise_arcsec = 1.5, .seed = seed});
    Sweep ccw =
        MakeSweep(kGear, {.from_deg = 360.0, .step_deg = -1.0, .noise_arcsec = 1.5, .seed = 1000 + seed});
    const double zero_rad = cw.input_rad.front();
    for (Sweep* sweep : {&cw, &ccw}) {
      for (double& input_rad : sweep->input_rad) input_rad -= zero_rad;
    }
    const Estimate mean = ComputeTransmissionError(cw.View(), ccw.View(), kRatio).ccw->e_avg_rad;
    const double truth_rad = -TrueError(kGear, 0.0);  // every line has the mean zero
    held += std::abs(mean.value - truth_rad) < 1.96 * mean.standard_error ? 1 : 0;
  }
  ExpectCoverageOf95(held, kTrials);
}

TEST(ComputeTransmissionError, MeasuresLostMotionOnOffsetGrids) {
  const Sweep cw = MakeSweep(kGear, {.offset_arcsec = 12.0, .noise_arcsec = 1.0, .seed = 1});
  const Sweep ccw = MakeSweep(
      kGear, {.from_deg = 360.3, .step_deg = -1.0, .offset_arcsec = -8.0, .noise_arcsec = 1.0, .seed = 2});
  const TransmissionError result = ComputeTransmissionError(cw.View(), ccw.View(), kRatio);
  EXPECT_EQ(result.failed_checks, Checks{});
  ASSERT_TRUE(result.lost_motion_rad);
  // The difference of two means over 360 samples with a noise of 1 arcsec each.
  const double error_arcsec = std::sqrt(2.0 / 360.0);
  EXPECT_NEAR(ArcsecFromRad(result.lost_motion_rad->value), 20.0, kByChance * error_arcsec);
  EXPECT_NEAR(ArcsecFromRad(result.lost_motion_rad->standard_error), error_arcsec,
              kByChance * SpreadOfDeviation(360.0) * error_arcsec);
}

TEST(TransmissionErrorChecks, SayWhatIsWrong) {
  const auto checks = [](const SweepPlan& plan, double ratio = kRatio) {
    const Sweep sweep = MakeSweep(kGear, plan);
    return ComputeTransmissionError(sweep.View(), {}, ratio).failed_checks;
  };
  EXPECT_EQ(checks({.samples = 341}),
            Checks{"cw: the sweep covers 341 deg of the output (expected 360 deg)"});
  EXPECT_EQ(checks({.samples = 360}), Checks{});
  EXPECT_EQ(checks({.step_deg = 12.0, .samples = 31}),
            Checks{"cw: 30 steps in the revolution (expected at least 36)"});
  EXPECT_EQ(checks({.ratio = 100.0}), Checks{"cw: ratio looks like 100, file says 80"});
  EXPECT_EQ(checks({.ratio = -80.0}), Checks{"cw: ratio looks like -80, file says 80"});
  EXPECT_EQ(checks({.ratio = 80.6}), Checks{});
}

TEST(TransmissionErrorChecks, SayThatASweepTurnsBackOrStandsStill) {
  Sweep sweep = MakeSweep({}, {});
  std::swap(sweep.output_rad[100], sweep.output_rad[101]);
  std::swap(sweep.input_rad[100], sweep.input_rad[101]);
  EXPECT_EQ(ComputeTransmissionError(sweep.View(), {}, kRatio).failed_checks,
            Checks{"cw: the output turns back at sample 101, at 100 deg"});
  const Sweep still = MakeSweep({}, {.step_deg = 0.0});
  const TransmissionError result = ComputeTransmissionError(still.View(), {}, kRatio);
  EXPECT_EQ(result.failed_checks, Checks{"cw: the output does not turn"});
  EXPECT_FALSE(result.cw);
}

TEST(TransmissionErrorChecks, SayThatBothSweepsTurnTheSameWay) {
  const Sweep sweep = MakeSweep(kGear, {});
  EXPECT_EQ(ComputeTransmissionError(sweep.View(), sweep.View(), kRatio).failed_checks,
            Checks{"the cw and the ccw sweep turn the same way"});
}

TEST(TransmissionErrorArguments, AreRefusedByName) {
  const Sweep sweep = MakeSweep(kGear, {});
  const AngleSweep view = sweep.View();
  EXPECT_EQ(MessageOf([&] { ComputeTransmissionError(view, {}, 0.0); }),
            "ratio = 0 is not a finite number other than zero");
  EXPECT_EQ(MessageOf([&] { ComputeTransmissionError({}, {}, 80.0); }),
            "cw and ccw are both empty (expected samples of one direction at least)");
  EXPECT_EQ(MessageOf([&] {
              ComputeTransmissionError({}, {view.input_angle_rad.first(9), view.output_angle_rad}, 80.0);
            }),
            "ccw.input_angle_rad has 9 values, ccw.output_angle_rad has 361 (expected the same number)");
}

// Ratio 90 by steps of 1 deg: the second harmonic changes sign from step to step, and its cosine alone is
// seen.
TEST(ComputeTransmissionError, GivesNoAmplitudeAtHalfTheStepsOfATurn) {
  const Sweep sweep = MakeSweep({{1, 10, 0.3}, {180, 40, 1.1}}, {.noise_arcsec = 0.5, .ratio = 90.0});
  const TransmissionError result = ComputeTransmissionError(sweep.View(), {}, 90.0);
  const auto& orders = result.cw->orders;
  const auto second = std::find_if(orders.begin(), orders.end(),
                                   [](const OrderLine& line) { return line.order_per_output_rev == 180.0; });
  ASSERT_NE(second, orders.end());
  EXPECT_TRUE(std::isnan(second->amplitude_rad.value));
  EXPECT_EQ(orders.front().order_per_output_rev, 1.0);
  EXPECT_EQ(
      result.failed_checks,
      Checks{"cw: order 180 (wave generator, 2nd harmonic) is half of 360 samples per output turn: how much "
             "of it is seen hangs on its phase (expected other steps: mean and range do not hold it)"});
}

TEST(ComputeTransmissionError, FailsACheckWhereTheSecondHarmonicLooksLikeAConstant) {
  const Sweep sweep = MakeSweep({{1, 10, 0.3}, {360, 40, 1.1}}, {.noise_arcsec = 0.5, .ratio = 180.0});
  EXPECT_EQ(
      ComputeTransmissionError(sweep.View(), {}, 180.0).failed_checks,
      Checks{"cw: order 360 (wave generator, 2nd harmonic) cannot be told from a constant (expected other "
             "steps: mean and range do not hold it)"});
}

}  // namespace
}  // namespace strainwave::analysis::transmission_error_test
