// SPDX-License-Identifier: Apache-2.0
#include "analysis/prediction/worth.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

namespace strainwave::analysis::prediction::prediction_worth_test {
namespace {

// Four reducers of five records, each measured at 100 + its number, give or take 1.
Samples FourReducers() {
  Samples samples{.features = Eigen::MatrixXd::Zero(20, 1),
                  .targets = Eigen::MatrixXd(20, 1),
                  .specimen = {},
                  .cycle = {},
                  .inputs = {"a"},
                  .outputs = {"k2_Nm_per_rad"}};
  for (int row = 0; row < 20; ++row) {
    samples.targets(row, 0) = 100.0 + row / 5 + (row % 2 == 0 ? 1.0 : -1.0);
    samples.specimen.push_back(row / 5);
    samples.cycle.push_back(row % 5);
  }
  return samples;
}

TEST(WorthOf, IsTheGainOverSayingTheMeanByGroups) {
  const Samples samples = FourReducers();
  const std::vector<Split> folds = SplitsBySpecimen(samples.specimen, 4);
  const Worth worth = WorthOf(samples, folds, samples.targets.array() * 1.002);
  // By hand: 0.2 % everywhere, against the mean of the three others.
  double sum = 0.0;
  double sum_of_squares = 0.0;
  double same_percent = 0.0;
  for (int reducer = 0; reducer < 4; ++reducer) {
    double others = 0.0;
    double error_percent = 0.0;
    for (int row = 0; row < 20; ++row) others += row / 5 == reducer ? 0.0 : samples.targets(row, 0) / 15.0;
    for (int row = 5 * reducer; row < 5 * reducer + 5; ++row)
      error_percent += 100.0 * std::abs(others / samples.targets(row, 0) - 1.0) / 5.0;
    const double gain = error_percent - 0.2;
    sum += gain;
    sum_of_squares += gain * gain;
    same_percent += error_percent / 4.0;
  }
  EXPECT_NEAR(worth.network_error_percent, 0.2, 1e-9);
  EXPECT_NEAR(worth.same_error_percent, same_percent, 1e-9);
  EXPECT_NEAR(worth.gain_percent, sum / 4.0, 1e-9);
  EXPECT_NEAR(worth.gain_se_percent, std::sqrt((sum_of_squares / 4.0 - sum * sum / 16.0) / 3.0), 1e-9);
  EXPECT_TRUE(worth.any());
}

TEST(WorthOf, IsNoneWhereTheGainIsChance) {
  const Samples samples = FourReducers();
  const std::vector<Split> folds = SplitsBySpecimen(samples.specimen, 4);
  Eigen::MatrixXd predicted(20, 1);
  for (const Split& fold : folds) {
    for (const Eigen::Index row : fold.test)
      predicted(row, 0) = samples.targets(fold.train, Eigen::all).mean();
  }
  EXPECT_FALSE(WorthOf(samples, folds, predicted).any()) << "the mean itself";
  // One group is hit; the others are a third further off than the mean.
  predicted += 0.3 * (predicted - samples.targets);
  for (const Eigen::Index row : folds.front().test) predicted(row, 0) = samples.targets(row, 0);
  const Worth one_of_four = WorthOf(samples, folds, predicted);
  EXPECT_GT(one_of_four.gain_percent, 0.0);
  EXPECT_FALSE(one_of_four.any()) << "one group alone is no evidence";
}

// Three bearings that are sound, one that is worn; left out, the worn one is unheard of.
TEST(WorthOf, ComparesClassesWithTheCommonestOfAll) {
  Samples samples = FourReducers();
  samples.classes = true;
  samples.outputs = {"sound", "worn"};
  samples.targets = Eigen::MatrixXd::Zero(20, 2);
  for (int row = 0; row < 20; ++row) samples.targets(row, row < 15 ? 0 : 1) = 1.0;
  const std::vector<Split> folds = SplitsBySpecimen(samples.specimen, 4);
  const Worth known = WorthOf(samples, folds, samples.targets);
  EXPECT_DOUBLE_EQ(known.network_error_percent, 0.0);
  EXPECT_DOUBLE_EQ(known.same_error_percent, 25.0);
  const Eigen::MatrixXd sound = Eigen::RowVector2d(0.9, 0.1).replicate(20, 1);
  EXPECT_FALSE(WorthOf(samples, folds, sound).any());
}

TEST(WorthOf, NeedsTwoGroups) {
  const Samples samples = FourReducers();
  EXPECT_THROW(WorthOf(samples, {SplitsBySpecimen(samples.specimen, 4).front()}, samples.targets),
               std::invalid_argument);
}

TEST(GroupsOfTest, AreSpecimensOrSegmentsOfOneLife) {
  const Samples samples = FourReducers();
  const Split last = SplitByTime(samples.specimen, samples.cycle, 0.4);
  const std::vector<Split> by_specimen = GroupsOfTest(samples, last);
  ASSERT_EQ(by_specimen.size(), 4U);
  EXPECT_EQ(by_specimen[1].test, (std::vector<Eigen::Index>{8, 9}));
  EXPECT_EQ(by_specimen[1].train, last.train);
  const std::vector<Split> segments = GroupsOfTest(samples, {.train = {0}, .test = {19, 15, 16, 17, 18}});
  ASSERT_EQ(segments.size(), 5U);
  EXPECT_EQ(segments.front().test, (std::vector<Eigen::Index>{15}));
  EXPECT_EQ(segments.back().test, (std::vector<Eigen::Index>{19}));
}

}  // namespace
}  // namespace strainwave::analysis::prediction::prediction_worth_test
