// SPDX-License-Identifier: Apache-2.0
#include "analysis/control_chart.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "tests/analysis/message_of.h"

namespace strainwave::analysis::control_chart_test {
namespace {

std::vector<double> Drift(std::uint32_t seed, int n, double slope) {
  std::mt19937 engine(seed);
  std::normal_distribution<double> normal;
  std::vector<double> values;
  for (int i = 0; i < n; ++i) {
    values.push_back(100.0 + slope * i + normal(engine));
  }
  return values;
}

TEST(NextValueLimits, CarriesAStraightTrendOn) {
  std::vector<double> history;
  for (int i = 0; i < 10; ++i) {
    history.push_back(5.0 - 0.25 * i);
  }
  const auto limits = NextValueLimits(history, {.sigma_floor = 0.1});
  ASSERT_TRUE(limits);
  EXPECT_NEAR(limits->centre, 2.5, 1e-12);
  EXPECT_DOUBLE_EQ(limits->sigma, 0.1);
  // Least squares' own: 1 + 1/10 + 5.5² / 82.5, ten points one step short of the next.
  EXPECT_NEAR(limits->upper - limits->centre, 3.0 * 0.1 * std::sqrt(1.0 + 0.1 + 5.5 * 5.5 / 82.5), 1e-12);
  EXPECT_FALSE(limits->IsOutlier(2.5));
  EXPECT_TRUE(limits->IsOutlier(3.0));
  EXPECT_TRUE(limits->IsOutlier(std::numeric_limits<double>::quiet_NaN()));
}

TEST(NextValueLimits, RaisesFewFalseAlarmsOnATrendAndSeesAJumpOfSixSigma) {
  int false_alarms = 0;
  int seen = 0;
  constexpr int kTrials = 2000;
  for (std::uint32_t seed = 1; seed <= kTrials; ++seed) {
    const std::vector<double> series = Drift(seed, 21, -0.5);
    const auto limits = NextValueLimits(std::span(series).first(20));
    false_alarms += limits->IsOutlier(series[20]) ? 1 : 0;
    seen += limits->IsOutlier(series[20] + 6.0) ? 1 : 0;
  }
  // 3 σ with σ from 19 ranges: rarer than 1 in 30, where known σ would give 1 in 370.
  EXPECT_LT(false_alarms, kTrials / 30);
  EXPECT_GT(seen, 0.85 * kTrials);
}

TEST(NextValueLimits, IsNotMovedByOutliersInTheHistory) {
  std::vector<double> history = Drift(4, 20, -0.5);
  const auto clean = NextValueLimits(history);
  history[7] += 40.0;
  history[15] -= 60.0;
  const auto limits = NextValueLimits(history);
  // Not a tenth of what 40 and 60 would move a mean of 20 by, which is 2 and 3, and the spread by 16.
  EXPECT_NEAR(limits->centre, clean->centre, 1.0) << "a standard deviation of the values";
  EXPECT_LT(limits->sigma, 2.0 * clean->sigma);
}

TEST(NextValueLimits, LooksAtTheWindowOnlyAndSkipsMissingValues) {
  std::vector<double> history(50, 1000.0);
  const std::vector<double> recent = Drift(4, 20, 0.0);
  history.insert(history.end(), recent.begin(), recent.end());
  EXPECT_EQ(NextValueLimits(history)->centre, NextValueLimits(recent)->centre);
  history[60] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NEAR(NextValueLimits(history)->centre, 100.0, 1.5);
}

TEST(NextValueLimits, WantsSixValues) {
  EXPECT_FALSE(NextValueLimits(std::vector<double>{1, 2, 3, 4, 5}));
  EXPECT_EQ(MessageOf([] { NextValueLimits({}, {.window = 3}); }),
            "window = 3 is too short (expected at least 6)");
  EXPECT_EQ(MessageOf([] { NextValueLimits({}, {.width = 0.0}); }), "width = 0 is not a positive number");
}

// The worked example of docs/sources.md#nist-handbook, 6.3.2.2: ten batches, and the limits that stand there.
TEST(IndividualsLimits, AreThoseOfTheHandbooksExample) {
  const std::vector<double> batches{49.6, 47.6, 49.9, 51.3, 47.8, 51.2, 52.6, 52.4, 53.6, 52.1};
  const auto limits = IndividualsLimits(batches);
  ASSERT_TRUE(limits);
  EXPECT_NEAR(limits->centre, 50.81, 5e-5);
  EXPECT_NEAR(limits->upper, 55.8041, 5e-5);
  EXPECT_NEAR(limits->lower, 45.8159, 5e-5);
  // "± 2.66 mean moving ranges", which is 3 / 1.128 to three digits.
  EXPECT_NEAR((limits->upper - limits->centre) / 1.8778, 2.66, 5e-3);
}

TEST(IndividualsLimits, HoldAllButOneIn370OfAQuietSeries) {
  const std::vector<double> series = Drift(7, 200'000, 0.0);
  const auto limits = IndividualsLimits(series);
  EXPECT_NEAR(limits->sigma, 1.0, 0.01);  // of the series; its own error is 0.003
  const auto outside =
      std::count_if(series.begin(), series.end(), [&](double value) { return limits->IsOutlier(value); });
  EXPECT_NEAR(static_cast<double>(outside), 200'000.0 / 370.0, 100.0);
}

TEST(IndividualsLimits, PassOverWhatIsMissingAndWantTwoValues) {
  const double none = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(IndividualsLimits(std::vector<double>{none, 3.0, none}));
  const auto limits = IndividualsLimits(std::vector<double>{none, 3.0, none, 5.0});
  ASSERT_TRUE(limits);
  EXPECT_DOUBLE_EQ(limits->centre, 4.0);
  EXPECT_DOUBLE_EQ(limits->sigma, 2.0 / 1.128);
}

}  // namespace
}  // namespace strainwave::analysis::control_chart_test
