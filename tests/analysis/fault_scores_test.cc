// SPDX-License-Identifier: Apache-2.0
#include "analysis/faults/fault_scores.h"

#include <cmath>
#include <limits>
#include <set>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

#include "analysis/faults/fault_folds.h"

namespace strainwave::analysis::faults::fault_scores_test {
namespace {

// One class a row.
Eigen::MatrixXd Classes(const std::vector<int>& classes, int count) {
  Eigen::MatrixXd targets = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(classes.size()), count);
  for (std::size_t i = 0; i < classes.size(); ++i) targets(static_cast<Eigen::Index>(i), classes[i]) = 1.0;
  return targets;
}

TEST(FaultFolds, LeaveEachGroupOutOnceAndNeverOnBothSides) {
  const std::vector<int> classes{0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2};
  const std::vector<int> unit{7, 7, 3, 3, 1, 1, 9, 9, 4, 4, 8, 8};
  const FaultFolds folds = FoldsByGroup(unit, Classes(classes, 3));
  EXPECT_EQ(folds.groups, 6U);
  EXPECT_TRUE(folds.untested.empty());
  std::multiset<Eigen::Index> tested;
  for (const prediction::Split& fold : folds.folds) {
    std::set<int> seen;
    for (const Eigen::Index row : fold.train) seen.insert(unit[static_cast<std::size_t>(row)]);
    for (const Eigen::Index row : fold.test) {
      EXPECT_EQ(seen.count(unit[static_cast<std::size_t>(row)]), 0U);
      tested.insert(row);
    }
  }
  EXPECT_EQ(tested.size(), 12U);
  EXPECT_EQ(std::set<Eigen::Index>(tested.begin(), tested.end()).size(), 12U);
}

TEST(FaultFolds, ManyUnitsOfAClassAreDealtApart) {
  std::vector<int> classes;
  std::vector<int> unit;
  for (int u = 0; u < 44; ++u) {
    classes.push_back(u % 4);
    unit.push_back(u);
  }
  const FaultFolds folds = FoldsByGroup(unit, Classes(classes, 4));
  EXPECT_EQ(folds.folds.size(), static_cast<std::size_t>(kMostFolds));
  EXPECT_TRUE(folds.untested.empty());
}

TEST(FaultFolds, WhatNothingTeachesIsNotTested) {
  // Class 2 has one unit: without it nothing is known of it.
  const FaultFolds folds = FoldsByGroup(std::vector<int>{0, 1, 2, 3, 4}, Classes({0, 0, 1, 1, 2}, 3));
  EXPECT_EQ(folds.untested, (std::vector<Eigen::Index>{4}));
  // Each class one unit: no split by unit is possible.
  EXPECT_TRUE(FoldsByGroup(std::vector<int>{0, 0, 1, 1}, Classes({0, 0, 1, 1}, 2)).empty());
  EXPECT_TRUE(FoldsByGroup(std::vector<int>{5, 5, 5, 5}, Classes({0, 0, 1, 1}, 2)).empty());
}

TEST(FaultFolds, AtRandomKeepTheSharesOfTheClasses) {
  std::vector<int> classes(40, 0);
  std::fill(classes.begin() + 30, classes.end(), 1);
  const Eigen::MatrixXd targets = Classes(classes, 2);
  const FaultFolds folds = FoldsAtRandom(targets, 5, 1);
  ASSERT_EQ(folds.folds.size(), 5U);
  for (const prediction::Split& fold : folds.folds) {
    EXPECT_EQ(fold.test.size(), 8U);
    EXPECT_EQ(targets(fold.test, 1).sum(), 2.0);
  }
  EXPECT_EQ(FoldsAtRandom(targets, 5, 1).folds.front().test, folds.folds.front().test);
  EXPECT_NE(FoldsAtRandom(targets, 5, 2).folds.front().test, folds.folds.front().test);
}

TEST(FaultFolds, PairsAreTestedBySingles) {
  Eigen::MatrixXd targets(5, 2);
  targets << 0, 0, 1, 0, 0, 1, 1, 1, 1, 1;
  const FaultFolds folds = SinglesToPairs(targets);
  ASSERT_EQ(folds.folds.size(), 1U);
  EXPECT_EQ(folds.folds.front().train, (std::vector<Eigen::Index>{0, 1, 2}));
  EXPECT_EQ(folds.folds.front().test, (std::vector<Eigen::Index>{3, 4}));
  EXPECT_TRUE(SinglesToPairs(targets.topRows(3)).empty());
}

Eigen::RowVectorXd Row(std::initializer_list<double> values) {
  Eigen::RowVectorXd row(static_cast<Eigen::Index>(values.size()));
  std::copy(values.begin(), values.end(), row.begin());
  return row;
}

TEST(DecideClass, KeepsToTheStatedRule) {
  const UndecidedRule rule{.least_probability = 0.6, .least_margin = 0.1};
  EXPECT_FALSE(DecideClass(Row({0.1, 0.8, 0.1}), 0.9, rule).undecided);
  EXPECT_EQ(DecideClass(Row({0.1, 0.8, 0.1}), 0.9, rule).most_probable, 1);
  EXPECT_TRUE(DecideClass(Row({0.1, 0.59, 0.31}), 0.9, rule).undecided);
  EXPECT_TRUE(DecideClass(Row({0.1, 0.8, 0.1}), 1.01, rule).undecided);
  EXPECT_TRUE(DecideClass(Row({0.1, 0.8, 0.1}), std::nan(""), rule).undecided);
  // Outputs that are no probabilities may all be high.
  EXPECT_TRUE(DecideClass(Row({0.95, 1.0, 0.0}), 0.5, rule).undecided);
}

TEST(DecideLabels, AreEachTheirOwn) {
  const UndecidedRule rule{.least_probability = 0.6, .least_margin = 0.1};
  const LabelDecision both = DecideLabels(Row({0.7, 0.9}), Row({0.5, 0.8}), 0.2, rule);
  EXPECT_EQ(both.present, (std::vector<bool>{true, true}));
  EXPECT_FALSE(both.undecided);
  EXPECT_TRUE(DecideLabels(Row({0.54, 0.0}), Row({0.5, 0.8}), 0.2, rule).undecided);
  EXPECT_THROW(DecideLabels(Row({0.5}), Row({0.5, 0.5}), 0.0, rule), std::invalid_argument);
}

TEST(ScoreClasses, CountWhatWasTested) {
  const double none = std::numeric_limits<double>::quiet_NaN();
  Eigen::MatrixXd probability(4, 2);
  probability << 0.9, 0.1, 0.2, 0.8, 0.45, 0.55, none, none;
  Eigen::VectorXd distance(4);
  distance << 0.5, 0.5, 0.5, none;
  const auto scores = ScoreClasses(Classes({0, 0, 1, 1}, 2), probability, distance, {});
  ASSERT_TRUE(scores);
  EXPECT_EQ(scores->tested, 3U);
  EXPECT_EQ(scores->undecided, 1U);
  EXPECT_DOUBLE_EQ(scores->accuracy, 2.0 / 3.0);
  EXPECT_DOUBLE_EQ(scores->decided_accuracy, 0.5);
  EXPECT_EQ(scores->confusion(0, 0), 1);
  EXPECT_EQ(scores->confusion(0, 1), 1);
  EXPECT_EQ(scores->confusion(1, 1), 1);
  EXPECT_FALSE(
      ScoreClasses(Classes({0}, 2), Eigen::MatrixXd::Zero(1, 2), Eigen::VectorXd::Constant(1, none), {}));
}

TEST(ScoreLabels, TellExactMatchesAndEachLabel) {
  Eigen::MatrixXd targets(3, 2);
  targets << 1, 0, 1, 1, 0, 0;
  Eigen::MatrixXd probability(3, 2);
  probability << 0.9, 0.1, 0.9, 0.2, 0.1, 0.9;
  const auto scores = ScoreLabels(targets, probability, Row({0.5, 0.5}), Eigen::VectorXd::Zero(3), {});
  ASSERT_TRUE(scores);
  EXPECT_DOUBLE_EQ(scores->exact, 1.0 / 3.0);
  EXPECT_DOUBLE_EQ(scores->one_wrong, 2.0 / 6.0);
  EXPECT_DOUBLE_EQ(scores->labels[0].F1(), 1.0);
  EXPECT_DOUBLE_EQ(scores->labels[1].F1(), 0.0);
  EXPECT_DOUBLE_EQ(scores->labels[1].Accuracy(), 1.0 / 3.0);
}

TEST(LabelThresholds, LieBetweenWhatIsThereAndWhatIsNot) {
  Eigen::MatrixXd targets(4, 1);
  targets << 0, 0, 1, 1;
  Eigen::MatrixXd probability(4, 1);
  probability << 0.05, 0.1, 0.3, 0.9;
  EXPECT_NEAR(LabelThresholds(targets, probability)(0), 0.2, 0.011);
  probability.setConstant(std::nan(""));
  EXPECT_DOUBLE_EQ(LabelThresholds(targets, probability)(0), 0.5);
}

}  // namespace
}  // namespace strainwave::analysis::faults::fault_scores_test
