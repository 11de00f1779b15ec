// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <random>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

#include "analysis/health/component_scores.h"
#include "analysis/health/feature_selection.h"
#include "analysis/health/levels.h"
#include "analysis/health/motor_cycles.h"
#include "analysis/health/what_if.h"

namespace strainwave::analysis::health::health_test {
namespace {

TEST(Levels, AreTheValuesWhereThereAreFew) {
  Eigen::MatrixXd health(5, 2);
  health << 0.5, 0, 0, 1, 1, 0, 0.5, 1, 0, 0;
  Eigen::MatrixXi expected(5, 2);
  expected << 1, 0, 0, 1, 2, 0, 1, 1, 0, 0;
  EXPECT_EQ(LevelsOf(health), expected);
}

TEST(Levels, AreSharesOfTheRowsWhereThereAreMany) {
  Eigen::MatrixXd health(40, 1);
  for (Eigen::Index i = 0; i < 40; ++i) health(i, 0) = static_cast<double>(i) / 39.0;
  const Eigen::MatrixXi levels = LevelsOf(health);
  EXPECT_EQ(levels.maxCoeff(), 3);
  for (int level = 0; level < 4; ++level) EXPECT_EQ((levels.array() == level).count(), 10);
}

TEST(Levels, ComponentsThatChangeTogetherAreOne) {
  Eigen::MatrixXd health(4, 3);
  health << 0, 0, 0, 0.5, 1, 0.25, 1, 0, 0.5, 0.5, 1, 0.25;
  EXPECT_EQ(DistinguishableComponents(health), 2);
}

// Two components of two levels, ten records a cell; features: rises with the first; rises with it where the
// second is new and falls where it is worn; noise; constant.
struct Cells {
  Eigen::MatrixXd features{40, 4};
  Eigen::MatrixXd health{40, 2};
};
Cells TwoByTwo() {
  std::mt19937_64 engine(3);
  std::normal_distribution<double> normal;
  Cells cells;
  for (Eigen::Index i = 0; i < 40; ++i) {
    const double first = i < 20 ? 0.0 : 1.0;
    const double second = i % 2 == 0 ? 0.0 : 1.0;
    cells.health.row(i) << first, second;
    cells.features.row(i) << 3.0 * first + 0.1 * normal(engine),
        (second == 0.0 ? 1.0 : -1.0) * first + 0.1 * normal(engine), normal(engine), 7.0;
  }
  return cells;
}

TEST(ComponentScores, OppositeTrendsCancelAsPrintedAndNotByMagnitude) {
  const Cells cells = TwoByTwo();
  const Eigen::MatrixXi levels = LevelsOf(cells.health);
  const ComponentScores printed = ScoreFeatures(cells.features, cells.health, levels, 0);
  EXPECT_EQ(printed.cells, 2);
  // All ten of a level below all ten of the other: mid-ranks 10.5 ∓ 5 against ranks 1 to 20, 5 √20 /
  // √(19·21/12)/√20.
  EXPECT_NEAR(printed.correlation(0), 5.0 / std::sqrt(399.0 / 12.0), 1e-12);
  EXPECT_NEAR(printed.correlation(1), 0.0, 1e-12);
  EXPECT_NEAR(printed.magnitudes(1), printed.magnitudes(0), 1e-12);
  EXPECT_EQ(printed.score(3), 0.0);
  EXPECT_NEAR(printed.score.maxCoeff(), printed.score(0), 1e-12);
  const ComponentScores magnitude = ScoreFeatures(cells.features, cells.health, levels, 0, {0.8, true});
  EXPECT_GT(magnitude.score(1), 0.7);
}

// Levels {1, 3} and {6, 8}: means 2, 7 about 4.5 give 2 · 2.5²; within 1 + 1 + 1 + 1.
TEST(ComponentScores, FisherRatioIsOfScatterSums) {
  Eigen::MatrixXd features(4, 1);
  features << 1, 3, 6, 8;
  Eigen::MatrixXd health(4, 1);
  health << 0, 0, 1, 1;
  const ComponentScores scores = ScoreFeatures(features, health, LevelsOf(health), 0);
  EXPECT_NEAR(scores.fisher(0), 12.5 / 4.0, 1e-12);
}

// Unique scores 0.1 … 0.5 by 0.1 with frequencies: differences over frequency are told by hand.
TEST(FeatureSelection, ThresholdIsWhereThePeakRisesMost) {
  Eigen::VectorXd score(12);
  score << 0.0, 0.02, 0.03, 0.05, 0.06, 0.08, 0.09, 0.10, 0.40, 0.41, 0.401, 0.05;
  const ScoreThreshold threshold = ThresholdOf(score);
  EXPECT_EQ(threshold.unique.size(), 10U);
  EXPECT_EQ(threshold.frequency[3], 2);
  EXPECT_NEAR(threshold.difference[3], 0.02 / 2, 1e-12);
  EXPECT_NEAR(threshold.threshold, 0.40, 1e-12);
  // Peaks before it: 0.02 at 0.02, 0.01 at 0.05 or 0.06, 0.02 at 0.08; its own 0.30 / 2.
  EXPECT_GT(threshold.rise_percent, 500.0);
  // Without rounding all scores differ.
  EXPECT_EQ(ThresholdOf(score, 0.0).unique.size(), 11U);
}

TEST(FeatureSelection, OfTwoThatAreAlikeTheBetterStays) {
  Eigen::MatrixXd features(6, 3);
  features << 1, 2, 5, 2, 4, 3, 3, 6, 8, 4, 8, 1, 5, 10, 9, 6, 12.1, 2;
  Eigen::VectorXd score(3);
  score << 0.90, 0.95, 0.92;
  const Selection selection = SelectFeatures(features, score);
  EXPECT_EQ(selection.kept, (std::vector<Eigen::Index>{1, 2}));
}

// A move at constant speed, as a state and a velocity.
void Add(std::vector<double>& state, std::vector<double>& velocity, double on, double speed, int rows) {
  for (int i = 0; i < rows; ++i) {
    state.push_back(on);
    velocity.push_back(speed);
  }
}

TEST(MotorCycles, ThereAndBackIsOneCycle) {
  std::vector<double> state;
  std::vector<double> velocity;
  for (int cycle = 0; cycle < 3; ++cycle) {
    Add(state, velocity, 0, 0, 40);
    Add(state, velocity, 1, 10, 50);
    Add(state, velocity, 0, 0, 60);
    Add(state, velocity, 1, -10, 50);
  }
  const MotorCycles cycles = CutCycles(state, velocity);
  EXPECT_EQ(cycles.moves_a_cycle, 2);
  ASSERT_EQ(cycles.cycles.size(), 2U);
  EXPECT_EQ(cycles.cycles[0].begin, 40U);
  EXPECT_EQ(cycles.cycles[0].count, 200U);
  EXPECT_EQ(cycles.cycles[1].begin, 240U);
}

TEST(MotorCycles, OnAndOnIsACycleAMove) {
  std::vector<double> state;
  std::vector<double> velocity;
  for (int cycle = 0; cycle < 4; ++cycle) {
    Add(state, velocity, 0, 0, 10);
    Add(state, velocity, 1, 5, 30);
  }
  Add(state, velocity, 0, 0, 10);
  const MotorCycles cycles = CutCycles(state, velocity);
  EXPECT_EQ(cycles.moves_a_cycle, 1);
  EXPECT_EQ(cycles.cycles.size(), 4U);
}

TEST(MotorCycles, OneCycleAndNoStateAreTakenWhole) {
  std::vector<double> state;
  std::vector<double> velocity;
  Add(state, velocity, 0, 0, 40);
  Add(state, velocity, 1, 10, 50);
  Add(state, velocity, 0, 0, 60);
  Add(state, velocity, 1, -10, 50);
  for (const std::vector<double>& given : {state, std::vector<double>(), std::vector<double>(200, 1.0)}) {
    const MotorCycles cycles = CutCycles(given, velocity);
    ASSERT_EQ(cycles.cycles.size(), 1U);
    EXPECT_EQ(cycles.cycles[0].count, 200U);
    EXPECT_EQ(cycles.moves_a_cycle, 0);
  }
}

// A surface that is known next to exactly, through the four corners of docs/sources.md#lee-2023, Fig. 16.
statistics::GaussianProcess FigureSixteen(double baseline, double noise) {
  Eigen::MatrixXd places(4, 2);
  places << 0, 0, 0.5, 0, 0, 0.83, 0.5, 0.83;
  Eigen::VectorXd values(4);
  values << baseline, 0.45 + baseline, 0.04 + baseline, 0.65 + baseline;
  return {statistics::Replicated(places, values),
          {1.0, Eigen::Vector2d(0.6, 0.6), noise},
          statistics::MeanOf::kConstant};
}

TEST(WhatIf, GivesTheSharesOfThePublishedExample) {
  const Eigen::Vector2d state(0.5, 0.83);
  const WhatIf answer = AskWhatIf(FigureSixteen(0.1, 1e-10), {}, state, IntervalOf::kMean);
  constexpr double kSurface = 1e-6;
  EXPECT_NEAR(answer.system.index.value, 0.75, kSurface);
  EXPECT_NEAR(answer.restored[0].index.value, 0.14, kSurface);
  EXPECT_NEAR(answer.restored[1].index.value, 0.55, kSurface);
  EXPECT_NEAR(answer.alone[0].value, 0.45, kSurface);
  EXPECT_NEAR(answer.alone[1].value, 0.04, kSurface);
  EXPECT_NEAR(answer.interaction.value, 0.16, kSurface);
  EXPECT_NEAR(answer.shapley[0].value, 0.53, kSurface);
  EXPECT_NEAR(answer.shapley[1].value, 0.12, kSurface);
  EXPECT_NEAR(answer.baseline.index.value, 0.1, kSurface);
  EXPECT_NEAR(answer.shapley[0].value + answer.shapley[1].value + answer.baseline.index.value,
              answer.system.index.value, 1e-9);
  EXPECT_EQ(answer.ranking, (std::vector<std::size_t>{0, 1}));
  EXPECT_FALSE(answer.tied_with_next[0]);
  EXPECT_FALSE(answer.extrapolated);
}

TEST(WhatIf, NoisyMeasurementsMakeTheRankingATie) {
  const WhatIf answer = AskWhatIf(FigureSixteen(0.0, 0.3), {}, Eigen::Vector2d(0.5, 0.83), IntervalOf::kMean);
  EXPECT_TRUE(answer.tied_with_next[0]);
  // A new measurement is less sure than the mean.
  const WhatIf measured =
      AskWhatIf(FigureSixteen(0.0, 0.3), {}, Eigen::Vector2d(0.5, 0.83), IntervalOf::kMeasurement);
  EXPECT_GT(measured.system.index.high, answer.system.index.high);
  EXPECT_EQ(measured.shapley[0].high, answer.shapley[0].high);
  EXPECT_EQ(measured.baseline.index.high, answer.baseline.index.high);
}

TEST(WhatIf, CornersBeyondWhatWasMeasuredAreMarked) {
  Eigen::MatrixXd places(3, 2);
  places << 0, 0, 1, 0, 0, 1;
  const statistics::GaussianProcess surface(statistics::Replicated(places, Eigen::Vector3d(0, 1, 2)),
                                            {1.0, Eigen::Vector2d(1, 1), 0.01},
                                            statistics::MeanOf::kConstant);
  EXPECT_TRUE(AskWhatIf(surface, {}, Eigen::Vector2d(1, 1), IntervalOf::kMean).system.extrapolated);
  EXPECT_FALSE(AskWhatIf(surface, {}, Eigen::Vector2d(0.4, 0.4), IntervalOf::kMean).extrapolated);
  EXPECT_THROW(AskWhatIf(surface, {}, Eigen::Vector3d(0, 0, 0), IntervalOf::kMean), std::invalid_argument);
}

// The interval of a Shapley value against draws of the joint posterior of all corners.
TEST(WhatIf, IntervalIsThatOfDrawsFromThePosterior) {
  const statistics::GaussianProcess surface = FigureSixteen(0.0, 0.05);
  const WhatIf answer = AskWhatIf(surface, {}, Eigen::Vector2d(0.3, 0.5), IntervalOf::kMean);
  Eigen::MatrixXd corners(4, 2);
  corners << 0, 0, 0.3, 0, 0, 0.5, 0.3, 0.5;
  const statistics::Posterior posterior = surface.At(corners);
  const Eigen::Vector4d weights(-0.5, 0.5, -0.5, 0.5);
  const double deviation = std::sqrt(weights.dot(posterior.covariance * weights));
  EXPECT_NEAR(answer.shapley[0].value, weights.dot(posterior.mean), 1e-12);
  EXPECT_NEAR(answer.shapley[0].high - answer.shapley[0].value, 1.959963984540054 * deviation, 1e-9);
}

}  // namespace
}  // namespace strainwave::analysis::health::health_test
