// SPDX-License-Identifier: Apache-2.0
#include "analysis/prediction/class_scores.h"

#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "analysis/prediction/binary_classifier.h"
#include "tests/analysis/message_of.h"

namespace strainwave::analysis::prediction::class_scores_test {
namespace {

TEST(AreaUnderCurve, IsHowOftenAFaultScoresHigher) {
  // By another route: all pairs.
  std::mt19937_64 engine(3);
  std::vector<int> actual;
  std::vector<double> score;
  for (int i = 0; i < 60; ++i) {
    actual.push_back(static_cast<int>(engine() % 3 == 0));
    score.push_back(static_cast<double>(engine() % 7) + 2.0 * actual.back());  // with ties
  }
  double higher = 0.0;
  double pairs = 0.0;
  for (std::size_t i = 0; i < score.size(); ++i) {
    for (std::size_t j = 0; j < score.size(); ++j) {
      if (actual[i] != 1 || actual[j] != 0) continue;
      pairs += 1.0;
      higher += score[i] > score[j] ? 1.0 : (score[i] == score[j] ? 0.5 : 0.0);
    }
  }
  EXPECT_NEAR(AreaUnderCurve(actual, score), higher / pairs, 1e-14);
  EXPECT_TRUE(std::isnan(AreaUnderCurve(std::vector<int>{1, 1}, std::vector<double>{0.1, 0.2})));
  EXPECT_THROW(AreaUnderCurve(std::vector<int>{1}, std::vector<double>{}), std::invalid_argument);
}

TEST(WilsonInterval, IsThePublishedOne) {
  // Newcombe (1998), Statistics in Medicine 17, table I, method 3: 81 of 263, 15 of 148, 0 of 20, 1 of 29.
  const double published[][4] = {
      {81, 263, 0.2553, 0.3662}, {15, 148, 0.0624, 0.1605}, {0, 20, 0.0, 0.1611}, {1, 29, 0.0061, 0.1718}};
  for (const auto& [hits, cases, low, high] : published) {
    const ShareInterval interval = WilsonInterval(hits, cases);
    EXPECT_NEAR(interval.low, low, 6e-5);
    EXPECT_NEAR(interval.high, high, 6e-5);
  }
  EXPECT_THROW(WilsonInterval(3, 2), std::invalid_argument);
  EXPECT_THROW(WilsonInterval(0, 0), std::invalid_argument);
}

// Two classes of two numbers each: shifted, or as a ring about the other, which no line parts.
struct TwoClasses {
  Eigen::MatrixXd features{400, 2};
  std::vector<int> actual;
};
TwoClasses Draw(bool ring, std::uint64_t seed) {
  std::mt19937_64 engine(seed);
  std::normal_distribution<double> normal;
  TwoClasses drawn;
  for (Eigen::Index row = 0; row < drawn.features.rows(); ++row) {
    const bool one = row % 2 == 1;
    drawn.actual.push_back(one ? 1 : 0);
    const double angle = 3.0 * normal(engine);
    const double x = 0.4 * normal(engine);
    const double y = 0.4 * normal(engine);
    if (ring && one) {
      drawn.features.row(row) << 2.0 * std::cos(angle) + x, 2.0 * std::sin(angle) + y;
    } else {
      drawn.features.row(row) << x + (one ? 2.0 : 0.0), 10.0 + y;
    }
    if (ring && !one) drawn.features.row(row) << x, y;
  }
  return drawn;
}

TEST(BinaryClassifiers, ScoreFaultsHigherAndAreRightAboutTheirThreshold) {
  for (const bool ring : {false, true}) {
    const TwoClasses train = Draw(ring, 1);
    const TwoClasses test = Draw(ring, 2);
    for (const BinaryKind kind : kBinaryKinds) {
      const Eigen::VectorXd score = TrainAndScore(kind, train.features, train.actual, test.features);
      const std::vector<double> scores(score.begin(), score.end());
      int right = 0;
      for (std::size_t i = 0; i < scores.size(); ++i)
        right += (scores[i] > ThresholdOf(kind)) == (test.actual[i] == 1) ? 1 : 0;
      if (ring && kind == BinaryKind::kLogisticRegression) {
        EXPECT_LT(right, 280);  // a line does not part a ring
        continue;
      }
      EXPECT_GT(right, 380) << NameOf(kind) << (ring ? " ring" : " shifted");
      EXPECT_GT(AreaUnderCurve(test.actual, scores), 0.97) << NameOf(kind);
      // The same bits again.
      EXPECT_EQ(score, TrainAndScore(kind, train.features, train.actual, test.features)) << NameOf(kind);
    }
  }
}

TEST(BinaryClassifiers, RefuseOneClass) {
  const Eigen::MatrixXd features = Eigen::MatrixXd::Zero(12, 1);
  EXPECT_EQ(
      MessageOf([&] { TrainAndScore(BinaryKind::kForest, features, std::vector<int>(12, 1), features); }),
      "12 rows with 12 classes, 12 of them 1 (expected as many, 10 or more, and both classes)");
}

}  // namespace
}  // namespace strainwave::analysis::prediction::class_scores_test
