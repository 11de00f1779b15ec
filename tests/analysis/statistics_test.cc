// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <numeric>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

#include "analysis/statistics/analysis_of_variance.h"
#include "analysis/statistics/convex_hull.h"
#include "analysis/statistics/ranks.h"

namespace strainwave::analysis::statistics::statistics_test {
namespace {

TEST(Ranks, EqualValuesShareTheMeanOfTheirRanks) {
  EXPECT_EQ(MidRanks(std::vector<double>{3.0, 1.0, 3.0, 2.0, 3.0}),
            (std::vector<double>{4.0, 1.0, 4.0, 2.0, 4.0}));
}

// Without ties, 1 − 6 Σ d² / (n (n² − 1)).
TEST(Ranks, SpearmanWithoutTiesIsTheShortFormula) {
  const std::vector<double> x{86, 97, 99, 100, 101, 103, 106, 110, 112, 113};
  const std::vector<double> y{2, 20, 28, 27, 50, 29, 7, 17, 6, 12};
  const std::vector<double> rank_x = MidRanks(x);
  const std::vector<double> rank_y = MidRanks(y);
  double squares = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) squares += std::pow(rank_x[i] - rank_y[i], 2);
  EXPECT_NEAR(SpearmanCorrelation(x, y), 1.0 - 6.0 * squares / 990.0, 1e-14);
}

// Two levels with many ties: by hand, ranks 1.5 1.5 3.5 3.5 against 1 2 3.5 3.5 are 4 / √(4 · 4.5).
TEST(Ranks, SpearmanWithTiesByHand) {
  EXPECT_NEAR(SpearmanCorrelation(std::vector<double>{0, 0, 1, 1}, std::vector<double>{5, 6, 7, 7}),
              4.0 / std::sqrt(4.0 * 4.5), 1e-14);
  EXPECT_EQ(SpearmanCorrelation(std::vector<double>{0, 0, 0}, std::vector<double>{1, 2, 3}), 0.0);
}

// docs/sources.md#lee-2023, table 2: the chances of the printed F with 36 degrees of freedom.
TEST(AnalysisOfVariance, ChancesOfPrintedFAreThePrintedOnes) {
  EXPECT_NEAR(ChanceOfF(4.09, 2, 36), 0.0251, 5e-5);
  EXPECT_NEAR(ChanceOfF(233.6, 2, 36), 2.4e-21, 0.1e-21);
  EXPECT_NEAR(ChanceOfF(5.38, 4, 36), 0.0017, 5e-5);
}

// The same table: F from sums of squares that are printed with four digits lies within their rounding, and
// the printed F within that.
TEST(AnalysisOfVariance, PrintedSumsGiveThePrintedFWithinTheirRounding) {
  struct Row {
    double sum, df, f, low, high;
  };
  constexpr double kHalf = 0.00005;
  constexpr double kError = 0.0030;
  for (const Row row : {Row{0.0007, 2, 4.09, 3.84, 4.58}, Row{0.0391, 2, 233.6, 230.0, 239.0},
                        Row{0.0018, 4, 5.38, 5.16, 5.64}}) {
    const double low = (row.sum - kHalf) / row.df / ((kError + kHalf) / 36.0);
    const double high = (row.sum + kHalf) / row.df / ((kError - kHalf) / 36.0);
    EXPECT_NEAR(low, row.low, 0.011 * row.low);
    EXPECT_NEAR(high, row.high, 0.011 * row.high);
    EXPECT_LT(low, row.f);
    EXPECT_GT(high, row.f);
  }
}

// Three by three cells of five values each whose sums are whole numbers: effects a, b and c = ab are added to
// the same five deviations in each cell, so that all sums of squares are known beforehand.
struct Layout {
  std::vector<double> values;
  Eigen::MatrixXi levels;
};
Layout ExactLayout() {
  const double first[] = {-2, 0, 2};
  const double second[] = {-1, 0, 1};
  const double both[3][3] = {{1, 0, -1}, {0, 0, 0}, {-1, 0, 1}};
  const double off[] = {-2, -1, 0, 1, 2};
  Layout layout{{}, Eigen::MatrixXi(45, 2)};
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      for (const double deviation : off) {
        layout.levels.row(static_cast<Eigen::Index>(layout.values.size())) << i, j;
        layout.values.push_back(10 + first[i] + second[j] + both[i][j] + deviation);
      }
    }
  }
  return layout;
}

TEST(AnalysisOfVariance, GivesTheSumsOfAnExactTable) {
  const Layout layout = ExactLayout();
  const VarianceTable table = AnalysisOfVariance(layout.values, layout.levels, {"hd", "tb"});
  ASSERT_EQ(table.rows.size(), 5U);
  EXPECT_EQ(NameOf(table.type), "balanced");
  // 15 (4 + 0 + 4), 15 (1 + 0 + 1), 5 · 4, 9 · 10.
  const double sums[] = {120.0, 30.0, 20.0, 90.0, 260.0};
  const int degrees[] = {2, 2, 4, 36, 44};
  const char* names[] = {"hd", "tb", "hd:tb", "error", "total"};
  for (std::size_t i = 0; i < 5; ++i) {
    EXPECT_EQ(table.rows[i].source, names[i]);
    EXPECT_NEAR(table.rows[i].sum_of_squares, sums[i], 1e-10);
    EXPECT_EQ(table.rows[i].degrees_of_freedom, degrees[i]);
    EXPECT_NEAR(table.rows[i].eta_squared, sums[i] / 260.0, 1e-12);
  }
  EXPECT_NEAR(table.rows[0].f, 60.0 / 2.5, 1e-10);
  EXPECT_NEAR(table.rows[2].f, 5.0 / 2.5, 1e-10);
  // For 2 degrees of freedom the chance has a closed form: (1 + 2 F / d)^(−d/2).
  EXPECT_NEAR(table.rows[1].p, std::pow(1.0 + 2.0 * 6.0 / 36.0, -18.0), 1e-12);
  EXPECT_LT(table.rows[0].partial_low, 120.0 / 210.0);
  EXPECT_GT(table.rows[0].partial_high, 120.0 / 210.0);
}

// Two by two, unbalanced, by hand: cells {1, 3}, {5}, {2}, {8, 10, 12}. Type III tests hypotheses on
// unweighted means of cells (2, 5, 2, 10): the sum of squares of a contrast c is (Σ c m)² / Σ (c² / n).
TEST(AnalysisOfVariance, TypeThreeIsThatOfUnweightedMeans) {
  const std::vector<double> values{1, 3, 5, 2, 8, 10, 12};
  Eigen::MatrixXi levels(7, 2);
  levels << 0, 0, 0, 0, 0, 1, 1, 0, 1, 1, 1, 1, 1, 1;
  const double inverse_counts = 1.0 / 2 + 1.0 + 1.0 + 1.0 / 3;
  const VarianceTable table = AnalysisOfVariance(values, levels, {"a", "b"});
  EXPECT_EQ(NameOf(table.type), "type III");
  EXPECT_NEAR(table.rows[0].sum_of_squares, std::pow(2 + 10 - 2 - 5, 2) / inverse_counts, 1e-10);
  EXPECT_NEAR(table.rows[1].sum_of_squares, std::pow(5 + 10 - 2 - 2, 2) / inverse_counts, 1e-10);
  EXPECT_NEAR(table.rows[2].sum_of_squares, std::pow(2 + 10 - 5 - 2, 2) / inverse_counts, 1e-10);
  EXPECT_NEAR(table.rows[3].sum_of_squares, 2.0 + 8.0, 1e-10);
}

// Type II of a main effect: what it adds to the other main effect. Of a within b, pooled over b: the weighted
// differences 0 (2 and 1 values) and 5 (1 and 3): (Σ w d)² / Σ w with w = n₁ n₂ / (n₁ + n₂).
TEST(AnalysisOfVariance, TypeTwoIsThatOfPooledDifferences) {
  const std::vector<double> values{1, 3, 5, 2, 8, 10, 12};
  Eigen::MatrixXi levels(7, 2);
  levels << 0, 0, 0, 0, 0, 1, 1, 0, 1, 1, 1, 1, 1, 1;
  const double first = 2.0 * 1.0 / 3.0;
  const double second = 1.0 * 3.0 / 4.0;
  const VarianceTable table = AnalysisOfVariance(values, levels, {"a", "b"}, SumsOfSquares::kTypeTwo);
  EXPECT_NEAR(table.rows[0].sum_of_squares, std::pow(first * 0 + second * 5, 2) / (first + second), 1e-10);
}

TEST(AnalysisOfVariance, AnEmptyCellIsSaidAndTakesADegreeOfFreedom) {
  Layout layout = ExactLayout();
  layout.values.resize(40);
  const Eigen::MatrixXi levels = layout.levels.topRows(40);
  const VarianceTable table = AnalysisOfVariance(layout.values, levels, {"hd", "tb"});
  EXPECT_EQ(NameOf(table.type), "type II");
  EXPECT_EQ(table.rows[2].degrees_of_freedom, 3);
  EXPECT_EQ(table.rows[3].degrees_of_freedom, 32);
  ASSERT_EQ(table.notes.size(), 1U);
  EXPECT_EQ(table.notes[0],
            "1 of 9 cells are empty: the full interaction cannot be estimated, and has the degrees of "
            "freedom that the "
            "cells leave it; sums of squares are of type II");
}

TEST(AnalysisOfVariance, ThreeFactorsHaveSevenTerms) {
  std::vector<double> values;
  Eigen::MatrixXi levels(16, 3);
  for (int i = 0; i < 16; ++i) {
    levels.row(i) << i / 8, i / 4 % 2, i / 2 % 2;
    values.push_back(4 * (i / 8) + 2 * (i / 4 % 2) + (i % 2 == 0 ? -1 : 1));
  }
  const VarianceTable table = AnalysisOfVariance(values, levels, {"a", "b", "c"});
  ASSERT_EQ(table.rows.size(), 9U);
  EXPECT_EQ(table.rows[6].source, "a:b:c");
  EXPECT_NEAR(table.rows[0].sum_of_squares, 64.0, 1e-10);
  EXPECT_NEAR(table.rows[1].sum_of_squares, 16.0, 1e-10);
  EXPECT_NEAR(table.rows[7].sum_of_squares, 16.0, 1e-10);
}

TEST(AnalysisOfVariance, OneValueACellHasTheInteractionForItsError) {
  Eigen::MatrixXi levels(6, 2);
  levels << 0, 0, 0, 1, 0, 2, 1, 0, 1, 1, 1, 2;
  const VarianceTable table = AnalysisOfVariance(std::vector<double>{1, 2, 4, 2, 5, 6}, levels, {"a", "b"});
  EXPECT_EQ(table.rows[2].source, "error");
  EXPECT_EQ(table.rows[2].degrees_of_freedom, 2);
  EXPECT_EQ(table.notes[0], "each cell has one value: a:b is the error");
}

std::string MessageOf(const std::vector<double>& values, const Eigen::MatrixXi& levels) {
  try {
    AnalysisOfVariance(values, levels, {"a"});
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

TEST(AnalysisOfVariance, RefusesWhatCannotBeTold) {
  EXPECT_EQ(MessageOf({1, 2, 3}, Eigen::MatrixXi::Zero(3, 1)), "a has one level (expected two or more)");
  Eigen::MatrixXi each(3, 1);
  each << 0, 1, 2;
  EXPECT_EQ(MessageOf({1, 2, 3}, each),
            "3 values for 3 estimated means leave nothing for the error (expected several values in a cell)");
}

// docs/sources.md#smithson-2001 has it of F(3, 32): the interval follows from the non-central distribution;
// here its ends are checked by what defines them.
TEST(AnalysisOfVariance, IntervalOfEtaIsZeroForAnEffectThatChanceWouldGive) {
  EXPECT_EQ(PartialEtaInterval(0.4, 2, 36).low, 0.0);
  const EtaInterval wide = PartialEtaInterval(5.0, 2, 20);
  const EtaInterval narrow = PartialEtaInterval(50.0, 2, 200);
  EXPECT_GT(wide.high - wide.low, narrow.high - narrow.low);
}

TEST(ConvexHull, TellsInsideFromOutside) {
  Eigen::MatrixXd points(5, 2);
  points << 0, 0, 1, 0, 0, 1, 1, 0.5, 0.5, 1;
  EXPECT_EQ(DistanceFromHull(points, Eigen::Vector2d(0.5, 0.5)), 0.0);
  EXPECT_EQ(DistanceFromHull(points, Eigen::Vector2d(1.0, 0.25)), 0.0);
  // The corner (1, 1) is cut off by the edge from (1, ½) to (½, 1): √2 / 4 away.
  EXPECT_NEAR(DistanceFromHull(points, Eigen::Vector2d(1.0, 1.0)), std::sqrt(2.0) / 4.0, 1e-5);
  EXPECT_NEAR(DistanceFromHull(points, Eigen::Vector2d(-0.5, 0.0)), 0.5, 1e-5);
}

}  // namespace
}  // namespace strainwave::analysis::statistics::statistics_test
