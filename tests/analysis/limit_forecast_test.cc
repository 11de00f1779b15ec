// SPDX-License-Identifier: Apache-2.0
#include "analysis/reliability/limit_forecast.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/analysis/simulated_lives.h"
#include "tests/analysis/straight_line_forecast.h"

namespace strainwave::analysis::reliability::limit_forecast_test {
namespace {

DegradationPath PowerOfCycles(double met, int cycles, double power, double noise, unsigned seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  DegradationPath path;
  for (int cycle = 1; cycle <= cycles; ++cycle) {
    path.cycle.push_back(cycle);
    path.way.push_back(std::pow(cycle / met, power) + noise * normal(random));
  }
  return path;
}

TEST(ForecastLimit, IsNearOnPowersOfTheCycles) {
  for (const double power : {0.7, 1.0, 1.5, 2.5}) {
    const LimitForecast forecast = ForecastLimit(PowerOfCycles(1000.0, 700, power, 0.005, 1), 0.9);
    ASSERT_TRUE(forecast.is_approached);
    EXPECT_NEAR(forecast.cycle, 1000.0, 100.0) << power;
    EXPECT_LT(forecast.interval.low, 1000.0) << power;
    EXPECT_GT(forecast.interval.high, 1000.0) << power;
    EXPECT_GE(forecast.interval.low, 700.0) << power;
  }
}

// 40 lives seen to 60 %, by laws that had no part in choosing the constants. Of 90 % intervals 36 hold on
// the average; three standard errors are 6.
TEST(ForecastLimit, CoversWhatItSaysAndIsNarrowerThanAStraightLine) {
  std::mt19937_64 random(20);
  int held = 0;
  std::vector<double> widths;
  std::vector<double> errors_of_lines;
  constexpr int kLives = 40;
  constexpr double kShare = 0.6;
  for (int i = 0; i < kLives; ++i) {
    const SimulatedLife life = DrawLife(kFiguresOnly[static_cast<std::size_t>(i) % 3], random);
    const DegradationPath seen = SeenTo(life, kShare);
    const LimitForecast forecast = ForecastLimit(seen, 0.9);
    ASSERT_TRUE(forecast.is_approached) << i;
    held += forecast.interval.low <= life.met && life.met <= forecast.interval.high;
    widths.push_back(std::log(forecast.interval.high / forecast.interval.low));
    errors_of_lines.push_back(std::abs(std::log(StraightLineForecast(seen) / life.met)));
  }
  EXPECT_NEAR(held, 36, 6);
  std::ranges::sort(widths);
  std::ranges::sort(errors_of_lines);
  // The straight line's interval that holds as many, as a factor up and down.
  const double by_line = 2.0 * errors_of_lines[static_cast<std::size_t>(held - 1)];
  EXPECT_LT(widths[kLives / 2], by_line);
}

TEST(ForecastLimit, IsNoneWhereTheLimitIsNotApproached) {
  DegradationPath level = PowerOfCycles(1e12, 100, 1.3, 0.01, 3);
  EXPECT_FALSE(ForecastLimit(level, 0.9).is_approached);
  for (std::size_t i = 0; i < level.way.size(); ++i) level.way[i] -= 0.001 * static_cast<double>(i);
  EXPECT_FALSE(ForecastLimit(level, 0.9).is_approached);
}

// Of level paths whose noise drifts as temperature does, no more than the level lets pass are forecast.
TEST(ForecastLimit, TakesNoDriftForATrend) {
  std::mt19937_64 random(4);
  std::normal_distribution<double> normal;
  int approached = 0;
  constexpr int kPaths = 60;
  for (int i = 0; i < kPaths; ++i) {
    DegradationPath path;
    double drift = 0.0;
    for (int cycle = 1; cycle <= 300; ++cycle) {
      drift = 0.9 * drift + std::sqrt(1.0 - 0.9 * 0.9) * normal(random);
      path.cycle.push_back(cycle);
      path.way.push_back(0.01 * drift + 0.01 * normal(random));
    }
    approached += ForecastLimit(path, 0.9).is_approached;
  }
  EXPECT_LE(approached, kPaths / 5);
}

TEST(ForecastLimit, IsTheSameEachTime) {
  const DegradationPath path = PowerOfCycles(500.0, 300, 1.2, 0.02, 5);
  const LimitForecast once = ForecastLimit(path, 0.9);
  const LimitForecast again = ForecastLimit(path, 0.9);
  ASSERT_TRUE(once.is_approached);
  EXPECT_EQ(once.cycle, again.cycle);
  EXPECT_EQ(once.interval.high, again.interval.high);
}

TEST(ForecastLimit, AsksForEightPoints) {
  try {
    ForecastLimit({{1, 2}, {0, 0.1}}, 0.9);
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_STREQ(error.what(), "cycle has 2 values (expected at least 8)");
  }
}

}  // namespace
}  // namespace strainwave::analysis::reliability::limit_forecast_test
