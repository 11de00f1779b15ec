// SPDX-License-Identifier: Apache-2.0
#include "analysis/faults/fault_network.h"

#include <cmath>
#include <random>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

#include "analysis/faults/fault_scores.h"
#include "tests/analysis/chance.h"

namespace strainwave::analysis::faults::fault_network_test {
namespace {

constexpr int kInputs = 5;

// Clouds about one place a class, five units each, which lie a little apart.
prediction::Samples Clouds(int classes, int a_unit, double deviation) {
  std::mt19937_64 engine(11);
  std::normal_distribution<double> normal;
  prediction::Samples samples;
  const int rows = classes * 5 * a_unit;
  samples.features.resize(rows, kInputs);
  samples.targets = Eigen::MatrixXd::Zero(rows, classes);
  Eigen::Index row = 0;
  for (int c = 0; c < classes; ++c) {
    for (int unit = 0; unit < 5; ++unit) {
      const double apart = 0.3 * normal(engine);
      for (int r = 0; r < a_unit; ++r, ++row) {
        for (int k = 0; k < kInputs; ++k)
          samples.features(row, k) =
              100.0 * (k + 1) + 3.0 * std::cos(2.0 * c + k) + apart + deviation * normal(engine);
        samples.targets(row, c) = 1.0;
        samples.specimen.push_back(5 * c + unit);
        samples.cycle.push_back(static_cast<double>(row));
      }
    }
  }
  for (int k = 0; k < kInputs; ++k) samples.inputs.push_back("x" + std::to_string(k));
  for (int c = 0; c < classes; ++c) samples.outputs.push_back("class" + std::to_string(c));
  samples.classes = true;
  return samples;
}

std::optional<ClassScores> ByUnit(const prediction::Samples& samples, const FaultNetworkSettings& settings) {
  const FaultFolds folds = FoldsByGroup(samples.specimen, samples.targets);
  const FaultCrossFit cross = CrossFitFaults(samples, folds, settings, InTurn, [] { return true; });
  return ScoreClasses(samples.targets, cross.probability, cross.distance, {});
}

TEST(FaultNetwork, TellsClassesOnUnitsThatItHasNotSeen) {
  const prediction::Samples samples = Clouds(3, 6, 0.3);
  for (const FaultLine line : {FaultLine::kOurs, FaultLine::kStudy}) {
    const auto scores =
        ByUnit(samples, {.line = line, .members = 1, .epochs = line == FaultLine::kOurs ? 60 : 2000});
    ASSERT_TRUE(scores);
    EXPECT_EQ(scores->tested, 90U);
    EXPECT_GT(scores->accuracy, 0.95) << NameOf(line);
  }
}

TEST(FaultNetwork, IsAtChanceWhereThereIsNothingToTell) {
  prediction::Samples samples = Clouds(2, 8, 0.3);
  std::mt19937_64 engine(2);
  for (Eigen::Index row = 0; row < samples.size(); ++row)
    for (Eigen::Index k = 0; k < kInputs; ++k)
      samples.features(row, k) = static_cast<double>(engine() % 1000U);
  const auto scores = ByUnit(samples, {.members = 1, .epochs = 60});
  ASSERT_TRUE(scores);
  const auto tested = static_cast<double>(scores->tested);
  ExpectShare(tested * scores->accuracy, tested, 0.5);
}

TEST(FaultNetwork, ProbabilitiesOfClassesAddUpToOneAndThoseOfLabelsLieBetweenZeroAndOne) {
  const prediction::Samples samples = Clouds(3, 4, 0.3);
  const auto classes =
      TrainFaultNetwork(samples, {.members = 2, .epochs = 20}).Predict(samples.features).mean;
  const auto labels =
      TrainFaultNetwork(samples, {.labels = true, .members = 2, .epochs = 20}).Predict(samples.features).mean;
  for (Eigen::Index row = 0; row < samples.size(); ++row) EXPECT_NEAR(classes.row(row).sum(), 1.0, 1e-12);
  EXPECT_GE(labels.minCoeff(), 0.0);
  EXPECT_LE(labels.maxCoeff(), 1.0);
}

TEST(FaultNetwork, SameSeedSameBits) {
  const prediction::Samples samples = Clouds(2, 4, 0.3);
  const FaultNetworkSettings settings{.members = 2, .epochs = 10, .seed = 4};
  const auto first = TrainFaultNetwork(samples, settings).members;
  EXPECT_EQ(first, TrainFaultNetwork(samples, settings).members);
  EXPECT_NE(first, TrainFaultNetwork(samples, {.members = 2, .epochs = 10, .seed = 5}).members);
}

TEST(FaultNetwork, ThatOfTheStudyEndsAtItsErrorOrItsGradient) {
  const prediction::Samples samples = Clouds(2, 6, 0.1);
  FaultNetworkSettings settings{.line = FaultLine::kStudy, .least_error = 0.05};
  const FaultTrainingCourse course = CourseOfTraining(samples, settings);
  EXPECT_EQ(course.end, "error");
  ASSERT_FALSE(course.training.empty());
  // Looked at now and then, so the last look is a little before the end.
  EXPECT_LT(course.training.back(), 0.1);
  settings.least_error = 1e-12;
  settings.least_gradient = 0.05;
  EXPECT_EQ(CourseOfTraining(samples, settings).end, "gradient");
  settings.least_gradient = 1e-12;
  settings.epochs = 30;
  EXPECT_EQ(CourseOfTraining(samples, settings).end, "epochs");
}

TEST(FaultNetwork, WhatLiesFarFromTheTrainingIsOutside) {
  const prediction::Samples samples = Clouds(2, 8, 0.3);
  const FaultNetworkSettings settings{.members = 1, .epochs = 20};
  const FaultCrossFit cross = CrossFitFaults(samples, FoldsByGroup(samples.specimen, samples.targets),
                                             settings, InTurn, [] { return true; });
  const prediction::FittedPredictor fitted = FitFaults(samples, settings, cross);
  EXPECT_LT(fitted.Predict(samples.features).distance.mean(), 1.0);
  const Eigen::MatrixXd far = samples.features.topRows(1).array() + 50.0;
  EXPECT_GT(fitted.Predict(far).distance(0), 1.0);
}

TEST(FaultNetwork, WhoeverWaitsNoLongerEndsIt) {
  const prediction::Samples samples = Clouds(2, 2, 0.3);
  EXPECT_THROW(CrossFitFaults(samples, FoldsAtRandom(samples.targets, 2, 1), {.members = 1, .epochs = 1},
                              InTurn, [] { return false; }),
               prediction::TrainingEnded);
}

TEST(FaultLine, HasTwoNames) {
  EXPECT_EQ(FaultLineOf("study"), FaultLine::kStudy);
  try {
    FaultLineOf("theirs");
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_STREQ(error.what(), "line = 'theirs' is not known (expected ours or study)");
  }
}

}  // namespace
}  // namespace strainwave::analysis::faults::fault_network_test
