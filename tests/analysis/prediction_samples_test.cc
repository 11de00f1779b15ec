// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <vector>

#include "analysis/prediction/baseline.h"
#include "analysis/prediction/correlation_filter.h"
#include "analysis/prediction/samples.h"
#include "analysis/prediction/scaler.h"
#include "analysis/prediction/scores.h"
#include "analysis/prediction/splits.h"
#include "tests/analysis/message_of.h"

namespace strainwave::analysis::prediction::prediction_samples_test {
namespace {

constexpr double kRounding = 1e-12;

Samples ThreeReducers() {
  Samples samples{.features = Eigen::MatrixXd(12, 2),
                  .targets = Eigen::MatrixXd(12, 1),
                  .specimen = {},
                  .cycle = {},
                  .inputs = {"left", "right"},
                  .outputs = {"k2"}};
  for (int i = 0; i < 12; ++i) {
    samples.features.row(i) << i, -i;
    samples.targets(i, 0) = 100.0 + i;
    samples.specimen.push_back(i % 3);
    samples.cycle.push_back(100.0 - i);  // the later row is the earlier cycle
  }
  return samples;
}

TEST(Samples, RowsAndInputsKeepWhatBelongsTogether) {
  const Samples some = Inputs(Rows(ThreeReducers(), {7, 2}), {1});
  ASSERT_EQ(some.size(), 2);
  EXPECT_EQ(some.features(0, 0), -7.0);
  EXPECT_EQ(some.targets(1, 0), 102.0);
  EXPECT_EQ(some.specimen, (std::vector<int>{1, 2}));
  EXPECT_EQ(some.cycle, (std::vector<double>{93.0, 98.0}));
  EXPECT_EQ(some.inputs, (std::vector<std::string>{"right"}));
}

TEST(Samples, SayWhichValueIsNotFinite) {
  Samples samples = ThreeReducers();
  EXPECT_EQ(MessageOf([&] { Check(samples); }), "no std::invalid_argument");
  samples.features(4, 1) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(MessageOf([&] { Check(samples); }), "feature right of row 4 is nan (expected a finite number)");
  samples = ThreeReducers();
  samples.cycle.pop_back();
  EXPECT_EQ(MessageOf([&] { Check(samples); }), "cycle has 11 values (expected 12)");
}

// Reducer 0 has rows 0, 3, 6, 9 and lives from the last of them to the first: 9 and 6 are its baseline, with
// the means 7.5, −7.5 and 107.5.
TEST(SinceBaseline, TellsLaterRecordsAsChangesSinceTheFirstOfEachReducer) {
  const Samples changes = SinceBaseline(ThreeReducers(), 2);
  ASSERT_EQ(changes.size(), 6);
  EXPECT_EQ(changes.specimen, (std::vector<int>{0, 1, 2, 0, 1, 2}));
  EXPECT_EQ(changes.cycle, (std::vector<double>{100, 99, 98, 97, 96, 95}));
  EXPECT_EQ(changes.features.row(0), Eigen::RowVector2d(0.0 - 7.5, 0.0 + 7.5));
  EXPECT_EQ(changes.targets(0, 0), 100.0 - 107.5);
  EXPECT_EQ(changes.targets(3, 0), 103.0 - 107.5);
  // Reducer 1: rows 10 and 7, the mean is 108.5.
  EXPECT_EQ(changes.targets(1, 0), 101.0 - 108.5);
  const Samples last = Rows(changes, {5, 3});
  EXPECT_EQ(Values(last, last.targets), Eigen::Vector2d(105.0, 103.0));
  EXPECT_EQ(Values(ThreeReducers(), ThreeReducers().targets), ThreeReducers().targets);
}

TEST(SinceBaseline, SaysWhatIsWrong) {
  EXPECT_EQ(MessageOf([] { SinceBaseline(ThreeReducers(), 0); }), "records = 0 (expected at least 1)");
  EXPECT_EQ(MessageOf([] { SinceBaseline(ThreeReducers(), 4); }),
            "a reducer has 4 records (expected more than the 4 of its baseline)");
  Samples classes = ThreeReducers();
  classes.classes = true;
  EXPECT_EQ(MessageOf([&] { SinceBaseline(classes, 1); }), "classes have no baseline (expected quantities)");
  EXPECT_EQ(MessageOf([] { BaselineOf({}, {}); }), "features has no row (expected one or more)");
}

// By hand: errors 1, 0, −1 of 10, 20, 40.
TEST(ScoresOf, FollowTheEquationsOfThePaper) {  // docs/sources.md#shivam-2023
  Eigen::MatrixXd actual(3, 1);
  actual << 10.0, 20.0, 40.0;
  Eigen::MatrixXd predicted(3, 1);
  predicted << 9.0, 20.0, 41.0;
  const OutputScore score = ScoresOf(actual, predicted).front();
  EXPECT_NEAR(score.nmse, 2.0 / 2100.0, kRounding);
  EXPECT_NEAR(score.mape_percent, 100.0 * (0.1 + 0.0 + 0.025) / 3.0, kRounding);
  EXPECT_NEAR(score.accuracy_percent, 100.0 - 12.5 / 3.0, kRounding);
  EXPECT_NEAR(score.rmse, std::sqrt(2.0 / 3.0), kRounding);
}

TEST(ScoresOf, RefuseAShareOfZero) {
  EXPECT_EQ(MessageOf([] { ScoresOf(Eigen::MatrixXd::Zero(2, 1), Eigen::MatrixXd::Ones(2, 1)); }),
            "actual has a zero in column 0 (expected none: an error is a share of it)");
  EXPECT_EQ(MessageOf([] { ScoresOf(Eigen::MatrixXd::Ones(2, 1), Eigen::MatrixXd::Ones(2, 2)); }),
            "predicted is 2 × 2, actual 2 × 1 (expected the same, from one row)");
}

TEST(Scaler, GivesMeanZeroAndSpreadOneAndGoesBack) {
  Eigen::MatrixXd values(4, 3);
  values << 1.0, 5.0, 0.1, 3.0, 5.0, 0.1, 1.0, 5.0, 0.1, 3.0, 5.0, 0.1;
  const Scaler scaler = Standardizing(values);
  const Eigen::MatrixXd scaled = scaler.Apply(values);
  EXPECT_NEAR(scaled(0, 0), -1.0, kRounding);
  EXPECT_NEAR(scaled(1, 0), 1.0, kRounding);
  EXPECT_NEAR(scaled(2, 1), 0.0, kRounding);  // does not vary: neither a division by zero …
  EXPECT_NEAR(scaled(2, 2), 0.0, kRounding);  // … nor one by what rounding leaves
  EXPECT_NEAR((scaler.Undo(scaled) - values).cwiseAbs().maxCoeff(), 0.0, kRounding);
  EXPECT_NEAR(Dividing(values).Apply(values)(1, 0), 1.5, kRounding);
}

// cos and sin over whole turns are not correlated; their sum is, with each of them, by 1/√2 = 0.707.
TEST(FilterCorrelated, KeepsTheFirstOfTwoThatSayTheSame) {
  constexpr int kRows = 64;
  Eigen::MatrixXd values(kRows, 6);
  for (int i = 0; i < kRows; ++i) {
    const double angle = 2.0 * M_PI * i / kRows;
    values.row(i) << std::cos(angle), std::sin(angle), 7.0 - 3.0 * std::cos(angle), 4.0,
        std::cos(angle) + std::sin(angle), std::numeric_limits<double>::quiet_NaN();
  }
  const auto columns = FilterCorrelated(values, 0.75);
  EXPECT_EQ(KeptColumns(columns), (std::vector<Eigen::Index>{0, 1, 4}));
  EXPECT_EQ(columns[2].like, 0);
  EXPECT_NEAR(columns[2].correlation, -1.0, kRounding);
  EXPECT_EQ(columns[3].like, -1);  // constant
  EXPECT_EQ(columns[5].like, -1);  // not a number
  EXPECT_EQ(KeptColumns(FilterCorrelated(values, 0.70)), (std::vector<Eigen::Index>{0, 1}));
  EXPECT_EQ(MessageOf([&] { FilterCorrelated(values, 1.5); }), "limit = 1.5 is not between 0 and 1");
}

void ExpectEachRowOnce(const Split& split, std::size_t rows) {
  std::set<Eigen::Index> all(split.train.begin(), split.train.end());
  all.insert(split.test.begin(), split.test.end());
  EXPECT_EQ(all.size(), rows);
  EXPECT_EQ(split.train.size() + split.test.size(), rows);
}

TEST(SplitByTime, TestsTheEndOfEachLife) {
  const Samples samples = ThreeReducers();
  const Split split = SplitByTime(samples.specimen, samples.cycle, 0.25);
  ExpectEachRowOnce(split, 12);
  // Four rows each, the last cycle is the row that comes first.
  EXPECT_EQ(split.test, (std::vector<Eigen::Index>{0, 1, 2}));
}

TEST(SplitsBySpecimen, LeaveNoReducerOnBothSides) {
  const Samples samples = ThreeReducers();
  const auto splits = SplitsBySpecimen(samples.specimen, 5);
  ASSERT_EQ(splits.size(), 3U);
  std::set<Eigen::Index> tested;
  for (const Split& split : splits) {
    ExpectEachRowOnce(split, 12);
    std::set<int> trained_on;
    for (const Eigen::Index row : split.train)
      trained_on.insert(samples.specimen[static_cast<std::size_t>(row)]);
    for (const Eigen::Index row : split.test) {
      EXPECT_FALSE(trained_on.contains(samples.specimen[static_cast<std::size_t>(row)]));
      tested.insert(row);
    }
  }
  EXPECT_EQ(tested.size(), 12U);
  const std::vector<int> one(4, 9);
  EXPECT_EQ(MessageOf([&] { SplitsBySpecimen(one, 3); }),
            "1 specimens in 3 folds (expected at least two of each)");
}

TEST(SplitAtRandom, IsTheSameForTheSameSeedOnly) {
  const Split split = SplitAtRandom(100, 0.3, 5);
  ExpectEachRowOnce(split, 100);
  EXPECT_EQ(split.test.size(), 30U);
  EXPECT_EQ(split.test, SplitAtRandom(100, 0.3, 5).test);
  EXPECT_NE(split.test, SplitAtRandom(100, 0.3, 6).test);
  EXPECT_EQ(MessageOf([] { SplitAtRandom(1, 0.3, 5); }),
            "1 rows to train and 0 to test (expected some on either side)");
}

TEST(SplitsByBlocks, KeepNeighboursTogetherAndShowEachFoldAllAges) {
  const std::vector<int> specimen(1000, 1);
  std::vector<double> cycle(1000);
  for (std::size_t i = 0; i < cycle.size(); ++i) cycle[i] = static_cast<double>(i);
  const auto splits = SplitsByBlocks(specimen, cycle, 5);
  ASSERT_EQ(splits.size(), 5U);
  for (const Split& split : splits) {
    ExpectEachRowOnce(split, 1000);
    EXPECT_EQ(split.test.size(), 200U);
    int edges = 0;
    for (std::size_t i = 1; i < split.test.size(); ++i) edges += split.test[i] != split.test[i - 1] + 1;
    EXPECT_EQ(edges, 3);  // four blocks
    EXPECT_LT(split.test.front(), 250);
    EXPECT_GT(split.test.back(), 750);
  }
}

}  // namespace
}  // namespace strainwave::analysis::prediction::prediction_samples_test
