// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <random>
#include <set>
#include <vector>

#include "analysis/features/decimation.h"
#include "analysis/prediction/conformal.h"
#include "analysis/prediction/importance.h"
#include "analysis/prediction/informative_records.h"
#include "analysis/prediction/novelty.h"
#include "analysis/prediction/ridge.h"
#include "analysis/prediction/scores.h"
#include "tests/analysis/chance.h"
#include "tests/analysis/message_of.h"

namespace strainwave::analysis::prediction::prediction_uncertainty_test {
namespace {

Eigen::MatrixXd Normal(Eigen::Index rows, Eigen::Index columns, std::uint32_t seed) {
  std::mt19937 engine(seed);
  std::normal_distribution<double> normal;
  return Eigen::MatrixXd::NullaryExpr(rows, columns, [&] { return normal(engine); });
}

// Errors of a reducer are its own offset and the scatter of its records: half of the variance each.
struct Errors {
  Eigen::MatrixXd value;
  std::vector<int> group;
};
Errors ErrorsOf(int groups, int records, std::uint32_t seed) {
  std::mt19937 engine(seed);
  std::normal_distribution<double> normal;
  Errors errors{Eigen::MatrixXd(groups * records, 1), {}};
  for (int g = 0; g < groups; ++g) {
    const double offset = normal(engine);
    for (int i = 0; i < records; ++i) {
      errors.value(g * records + i, 0) = offset + normal(engine);
      errors.group.push_back(g);
    }
  }
  return errors;
}

TEST(CalibrateBand, CoversNewReducersAsOftenAsItSays) {
  // Mean over many calibrations on 24 reducers, each tried on 200 new ones: 0.90 to 0.94, since a weight of
  // 1/25 lies at infinity. Calibrated as if records were on their own it would be 0.90 less what 24 offsets
  // in the place of 24 · 30 leave uncertain.
  double inside = 0.0;
  constexpr int kCalibrations = 60;
  for (std::uint32_t k = 0; k < kCalibrations; ++k) {
    const Errors seen = ErrorsOf(24, 30, 2 * k);
    const Errors unseen = ErrorsOf(200, 30, 2 * k + 1);
    const auto zero = [](const Errors& e) { return Eigen::MatrixXd::Zero(e.value.rows(), 1).eval(); };
    const auto one = [](const Errors& e) { return Eigen::MatrixXd::Ones(e.value.rows(), 1).eval(); };
    const ConformalBand band = CalibrateBand(seen.value, zero(seen), one(seen), seen.group, 0.9);
    EXPECT_TRUE(band.guaranteed);
    inside += CoverageOf(band, unseen.value, zero(unseen), one(unseen))(0) / kCalibrations;
  }
  EXPECT_GT(inside, 0.90);
  EXPECT_LT(inside, 0.94);
}

TEST(CalibrateBand, WidensWhereThePredictorWasUnsure) {
  Eigen::MatrixXd actual(10, 1);
  Eigen::MatrixXd spread(10, 1);
  std::vector<int> group;
  for (int i = 0; i < 10; ++i) {
    spread(i, 0) = i < 5 ? 1.0 : 10.0;
    actual(i, 0) = 2.0 * spread(i, 0);
    group.push_back(i);
  }
  const ConformalBand band = CalibrateBand(actual, Eigen::MatrixXd::Zero(10, 1), spread, group, 0.8);
  EXPECT_DOUBLE_EQ(band.factor(0), 2.0);
}

TEST(CalibrateBand, PromisesNothingFromTooFewReducers) {
  const Errors seen = ErrorsOf(3, 40, 1);
  const ConformalBand band = CalibrateBand(seen.value, Eigen::MatrixXd::Zero(120, 1),
                                           Eigen::MatrixXd::Ones(120, 1), seen.group, 0.9);
  EXPECT_FALSE(band.guaranteed);
  EXPECT_DOUBLE_EQ(band.factor(0), seen.value.cwiseAbs().maxCoeff());
  EXPECT_EQ(MessageOf([&] {
              CalibrateBand(seen.value, Eigen::MatrixXd::Zero(120, 1), Eigen::MatrixXd::Zero(120, 1),
                            seen.group, 0.9);
            }),
            "spread has a value that is not positive");
}

// Two calm reducers of 10 records and a wild one of 20, each left out in turn: the wild one is never held by
// what the calm ones promise, and the calm ones always.
TEST(LeftOutCoverage, JudgesAReducerByTheOthers) {
  Eigen::MatrixXd actual(40, 1);
  std::vector<int> group;
  std::vector<Split> folds(3);
  for (int row = 0; row < 40; ++row) {
    const int own = row < 10 ? 0 : row < 20 ? 1 : 2;
    actual(row, 0) = own == 2 ? 10.0 : 1.0;
    group.push_back(own);
    for (int fold = 0; fold < 3; ++fold) (fold == own ? folds[fold].test : folds[fold].train).push_back(row);
  }
  const Eigen::MatrixXd zero = Eigen::MatrixXd::Zero(40, 1);
  const Eigen::MatrixXd one = Eigen::MatrixXd::Ones(40, 1);
  const Eigen::RowVectorXd share = LeftOutCoverage(actual, zero, one, group, folds, 0.6);
  EXPECT_DOUBLE_EQ(share(0), 0.5);
  EXPECT_DOUBLE_EQ(CoverageOf(CalibrateBand(actual, zero, one, group, 0.6), actual, zero, one)(0), 1.0);
}

TEST(FitNovelty, MeasuresInTheSpreadOfTheRecordsThemselves) {
  // Two inputs that move together: one step along their common direction is usual, one across is not.
  Eigen::MatrixXd features = Normal(4000, 2, 3);
  features.col(1) = features.col(0) + 0.5 * features.col(1);
  const Novelty novelty = FitNovelty(features, features.topRows(1000), 0.99);
  Eigen::MatrixXd asked(2, 2);
  asked << 1.0, 1.0, 1.0, -1.0;
  const Eigen::VectorXd distance = novelty.Distance(asked);
  EXPECT_LT(distance(0), 1.0);
  // Covariance (1 1; 1 1.25), inverse (5 −4; −4 4): x = (1, −1) has 17, over two inputs √8.5.
  EXPECT_NEAR(distance(1), std::sqrt(8.5), 0.05 * std::sqrt(8.5));
  EXPECT_GT(distance(1), novelty.limit);
  EXPECT_GT(novelty.limit, distance(0));
}

TEST(FitNovelty, StaysWellConditionedWithMoreInputsThanRecords) {
  const Eigen::MatrixXd features = Normal(20, 50, 4);
  const Novelty novelty = FitNovelty(features, Normal(200, 50, 5), 0.99);
  const Eigen::VectorXd usual = novelty.Distance(Normal(200, 50, 6));
  // One in a hundred of 200, by a limit that is itself the third largest of 200.
  EXPECT_LT((usual.array() > novelty.limit).cast<double>().sum(),
            2.0 + kByChance * std::sqrt(2.0) * SpreadOfCount(200.0, 0.01));
  EXPECT_GT(novelty.Distance(5.0 * Normal(1, 50, 7))(0), novelty.limit);
  EXPECT_EQ(MessageOf([&] { FitNovelty(features, Normal(2, 3, 1), 0.99); }),
            "features is 20 × 50, apart 2 × 3 (expected at least 3 rows and 1 row, and the same columns)");
}

// The penalty written as rows of the design: ‖Y − XB‖² + nλ‖B‖² is an ordinary least-squares problem with
// √(nλ)·I below X and zeros below Y.
TEST(FitRidge, EqualsLeastSquaresWithThePenaltyAsFurtherRows) {
  const Eigen::MatrixXd features = Normal(60, 4, 8);
  Eigen::MatrixXd targets = features * Normal(4, 2, 9) + 0.5 * Normal(60, 2, 10);
  targets.array() += 3.0;
  std::vector<int> group;
  for (int i = 0; i < 60; ++i) group.push_back(i / 10);
  const Ridge ridge = FitRidge(features, targets, group);
  Eigen::MatrixXd design(64, 4);
  design << features.rowwise() - features.colwise().mean(),
      std::sqrt(60.0 * ridge.penalty) * Eigen::MatrixXd::Identity(4, 4);
  Eigen::MatrixXd right(64, 2);
  right << targets.rowwise() - targets.colwise().mean(), Eigen::MatrixXd::Zero(4, 2);
  const Eigen::MatrixXd slope = design.colPivHouseholderQr().solve(right);
  constexpr double kRounding = 1e-10;
  EXPECT_NEAR((slope - ridge.slope).cwiseAbs().maxCoeff(), 0.0, kRounding);
  EXPECT_NEAR((ridge.Predict(features).colwise().mean() - targets.colwise().mean()).norm(), 0.0, kRounding);
}

TEST(FitRidge, ShrinksMoreWhereThereIsMoreNoise) {
  const Eigen::MatrixXd features = Normal(60, 40, 11);
  const Eigen::MatrixXd signal = features.col(0);
  const std::vector<int> group(60, 1);
  const double clear = FitRidge(features, signal + 0.01 * Normal(60, 1, 12), group).penalty;
  const double noisy = FitRidge(features, signal + 5.0 * Normal(60, 1, 12), group).penalty;
  EXPECT_LT(clear, noisy);
}

TEST(PermutationImportance, FindsWhatThePredictorLooksAt) {
  const Eigen::MatrixXd features = Normal(500, 3, 13);
  const auto predict = [](const Eigen::MatrixXd& x) -> Eigen::MatrixXd {
    return (10.0 + 0.2 * x.col(0).array() + 1.0 * x.col(2).array()).matrix();
  };
  const auto mape = [&](const Eigen::MatrixXd& x) {
    return MeanMape_percent(ScoresOf(predict(features), predict(x)));
  };
  const auto found =
      PermutationImportance(mape, features, {{"little", {0}}, {"unused", {1}}, {"much", {2}}}, 4, 1);
  ASSERT_EQ(found.size(), 3U);
  EXPECT_EQ(found[0].name, "much");
  EXPECT_EQ(found[1].name, "little");
  EXPECT_EQ(found[2].name, "unused");
  EXPECT_EQ(found[2].error_rise_percent, 0.0);
  // |x − x'| of two normals has the mean 2/√π: 11.3 % of 10, a little more since 1/y is convex.
  EXPECT_NEAR(found[0].error_rise_percent, 11.3, 0.6);
}

TEST(Confusion, CountsOwnClassesDownAndGivenOnesAcross) {
  Eigen::MatrixXd actual(4, 2);
  actual << 1, 0, 1, 0, 0, 1, 0, 1;
  Eigen::MatrixXd predicted(4, 2);
  predicted << 0.9, 0.1, 0.2, 0.8, 0.4, 0.6, 0.3, 0.7;
  const Eigen::MatrixXi counts = Confusion(actual, predicted);
  EXPECT_EQ(counts, (Eigen::MatrixXi(2, 2) << 1, 1, 0, 2).finished());
  EXPECT_EQ(Accuracy_percent(counts), 75.0);
}

// A tone below the new Nyquist frequency stays, one above it would come back as another.
TEST(Decimate, KeepsWhatIsBelowTheNewNyquistFrequencyAndLosesWhatIsAbove) {
  const auto tone = [](double cycles_per_sample, int count) {
    std::vector<double> values;
    for (int i = 0; i < count; ++i) values.push_back(std::sin(2.0 * M_PI * cycles_per_sample * i));
    return values;
  };
  const std::vector<double> kept = features::Decimate(tone(0.02, 4000), 4);
  ASSERT_EQ(kept.size(), 1000U);
  const std::vector<double> expected = tone(0.08, 1000);
  constexpr double kSixtyDecibels = 1e-3;  // what the filter leaves, and its ripple
  for (std::size_t i = 20; i < 980; ++i) EXPECT_NEAR(kept[i], expected[i], kSixtyDecibels);
  const std::vector<double> lost = features::Decimate(tone(0.145, 4000), 4);
  for (std::size_t i = 20; i < 980; ++i) EXPECT_NEAR(lost[i], 0.0, kSixtyDecibels);
  EXPECT_EQ(MessageOf([] { features::Decimate(std::vector<double>{1.0}, 0); }),
            "factor = 0 is not from 1 up");
}

TEST(ChooseInformative, SpreadsOverWhatThereIs) {
  // A crowd at zero, and four corners of a square.
  Eigen::MatrixXd features = 0.01 * Normal(104, 2, 14);
  features.bottomRows(4) << 1, 1, 1, -1, -1, 1, -1, -1;
  const auto chosen = ChooseInformative(features, 5);
  EXPECT_LT(chosen.front(), 100);
  EXPECT_EQ(std::set<Eigen::Index>(chosen.begin() + 1, chosen.end()),
            (std::set<Eigen::Index>{100, 101, 102, 103}));
  const auto all = ChooseInformative(Eigen::MatrixXd::Ones(6, 2), 6);
  EXPECT_EQ(std::set<Eigen::Index>(all.begin(), all.end()).size(), 6U);
  EXPECT_EQ(MessageOf([&] { ChooseInformative(features, 105); }), "count = 105 (expected 1 to 104)");
}

}  // namespace
}  // namespace strainwave::analysis::prediction::prediction_uncertainty_test
