// SPDX-License-Identifier: Apache-2.0
#include "analysis/prediction/fit_predictor.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace strainwave::analysis::prediction::prediction_fit_test {
namespace {

// Six reducers of ten records; the output follows the feature alone, which has nothing to do with the cycle.
Samples OfAFeature() {
  Samples samples{.features = Eigen::MatrixXd(60, 1),
                  .targets = Eigen::MatrixXd(60, 1),
                  .specimen = {},
                  .cycle = {},
                  .inputs = {"accel_x.a1.variance"},
                  .outputs = {"k2_Nm_per_rad"}};
  for (int row = 0; row < 60; ++row) {
    const double feature = (row * 37) % 60;
    samples.features(row, 0) = feature;
    samples.targets(row, 0) = 1000.0 - feature;
    samples.specimen.push_back(row / 10);
    samples.cycle.push_back(1.0 + row % 10);
  }
  return samples;
}

double MapeOf(const std::vector<Contestant>& contestants, const std::string& name) {
  return std::ranges::find(contestants, name, &Contestant::name)->scores.at(0).mape_percent;
}

TEST(CompareFolds, JudgesEveryRecordByWhatHadNotSeenItsFold) {
  const Samples samples = OfAFeature();
  const std::vector<Split> folds = HonestFolds(samples, 3);
  const CrossFit cross{
      .predicted = samples.targets.array() * 1.01, .spread = samples.targets, .distance = {}};
  const auto contestants = CompareFolds(samples, folds, cross);
  ASSERT_EQ(contestants.size(), 5U);
  EXPECT_EQ(contestants.front().name, "network");
  EXPECT_NEAR(MapeOf(contestants, "network"), 1.0, 1e-9);
  EXPECT_LT(MapeOf(contestants, "ridge"), 0.05);
  EXPECT_GT(MapeOf(contestants, "cycle number alone"), 1.0) << "the cycle says nothing here";

  // The mean of the other folds, by hand.
  double sum_percent = 0.0;
  for (const Split& fold : folds) {
    const Samples train = Rows(samples, fold.train);
    const Samples test = Rows(samples, fold.test);
    sum_percent += 100.0 * (1.0 - train.targets.mean() / test.targets.array()).abs().sum();
  }
  EXPECT_NEAR(MapeOf(contestants, "mean"), sum_percent / 60.0, 1e-9);
}

// A worn reducer is more worn than any that taught the network; noise may throw an input anywhere.
TEST(TrainEnsemble, GoesOnAlongItsLineWhereTheTrainingEndedButNotWithoutEnd) {
  const Samples samples = OfAFeature();  // 0 to 59
  EnsembleSettings settings{
      .design = {{1, 1}, {networks::Dense{8, networks::Activation::kTanh}, networks::Dense{1}}},
      .training = {.loss = networks::Loss::kMse, .epochs = 200, .seed = 3},
      .members = 2,
      .validation_share = 0.2};
  const auto at = [&](double feature) {
    return TrainEnsemble(samples, settings).Predict(Eigen::MatrixXd::Constant(1, 1, feature)).mean(0, 0);
  };
  EXPECT_GT(std::abs(at(70.0) - 930.0), 5.0);
  settings.beside_line = true;
  EXPECT_NEAR(at(70.0), 930.0, 1.0);
  EXPECT_NEAR(at(1e4), at(1e3), 1.0);
}

// What the line leaves is the networks'.
TEST(TrainEnsemble, BesideALineStillLearnsACurve) {
  Samples samples = OfAFeature();
  samples.targets = 1000.0 - samples.features.array() + 30.0 * (samples.features.array() / 15.0).sin();
  const EnsembleSettings settings{
      .design = {{1, 1}, {networks::Dense{32, networks::Activation::kTanh}, networks::Dense{1}}},
      .training = {.loss = networks::Loss::kMse, .epochs = 3000, .seed = 3},
      .beside_line = true};
  const Eigen::MatrixXd off =
      samples.targets - TrainEnsemble(samples, settings).Predict(samples.features).mean;
  EXPECT_LT(off.cwiseAbs().maxCoeff(), 3.0) << "of 30 that no line explains";
}

// Changes since a baseline are judged as the values that they lead to.
TEST(Judge, AddsChangesToWhatTheyAreChangesFrom) {
  Samples samples = OfAFeature();
  samples.origin = Eigen::MatrixXd::Constant(60, 1, 9000.0);
  const Contestant judged = Judge("network", samples, samples.targets.array() + 100.0);
  EXPECT_NEAR(judged.scores.at(0).mape_percent, (1e4 / (9000.0 + samples.targets.array())).mean(), 1e-9);
}

}  // namespace
}  // namespace strainwave::analysis::prediction::prediction_fit_test
