// SPDX-License-Identifier: Apache-2.0
#include "analysis/reliability/degradation.h"

#include <cmath>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "analysis/reliability/prognostic_features.h"
#include "analysis/reliability/weibull_fit.h"
#include "tests/analysis/simulated_lives.h"

namespace strainwave::analysis::reliability::degradation_test {
namespace {

constexpr double kPower = 1.3;

// A path that meets its limit at a cycle, of which so many are seen.
DegradationPath PathTo(double met, int cycles, double noise, std::mt19937& random) {
  std::normal_distribution<double> normal;
  DegradationPath path;
  for (int cycle = 1; cycle <= cycles; ++cycle) {
    path.cycle.push_back(cycle);
    path.way.push_back(std::pow(cycle / met, kPower) + noise * normal(random));
  }
  return path;
}

// Lives are lognormal about 1000 cycles with a known spread, 600 cycles of them seen: B10 and B50 come back.
// (Of 40 such draws the 90 % interval of the deviation missed it in 1.)
TEST(LifeFromDegradation, RecoversALognormalPopulation) {
  std::mt19937 random(4);
  std::normal_distribution<double> normal;
  std::vector<DegradationPath> paths;
  constexpr double kSpread = 0.2;
  for (int i = 0; i < 12; ++i)
    paths.push_back(PathTo(1000.0 * std::exp(kSpread * normal(random)), 600, 0.01, random));
  const DegradationLife life = LifeFromDegradation(paths, {0.1, 0.5}, 0.9);
  const double b10 = 1000.0 * std::exp(-1.2816 * kSpread);
  EXPECT_LT(life.quantiles[0].interval.low, b10);
  EXPECT_GT(life.quantiles[0].interval.high, b10);
  EXPECT_LT(life.quantiles[1].interval.low, 1000.0);
  EXPECT_GT(life.quantiles[1].interval.high, 1000.0);
  EXPECT_NEAR(std::log(life.quantiles[1].value / 1000.0), 0.0, 0.15);
  EXPECT_LT(life.log_deviation.interval.low, kSpread);
  EXPECT_GT(life.log_deviation.interval.high, kSpread);
  EXPECT_EQ(life.pseudo_failures.size(), 12U);
}

// Where all have met their limit there is nothing to forecast. With a flat prior of the deviation the mean of
// n logarithms is Student's t with n − 2 degrees of freedom (docs/sources.md#gelman-2006), and six that
// differ this little hardly see that the prior falls off.
TEST(LifeFromDegradation, OfFailuresAloneIsThatOfTheirLogarithms) {
  std::mt19937 random(7);
  std::vector<DegradationPath> paths;
  std::vector<double> logs;
  for (const double met : {300.0, 340.0, 400.0, 410.0, 480.0, 520.0}) {
    paths.push_back(PathTo(met, 600, 0.0, random));
    logs.push_back(std::log(met));
  }
  double mean = 0.0;
  for (const double log : logs) mean += log / 6.0;
  double square = 0.0;
  for (const double log : logs) square += (log - mean) * (log - mean) / 4.0;
  const double half = 2.132 * std::sqrt(square / 6.0);
  const DegradationLife life = LifeFromDegradation(paths, {0.5}, 0.9);
  EXPECT_NEAR(std::log(life.quantiles[0].value), mean, 0.02);
  EXPECT_NEAR(std::log(life.quantiles[0].interval.high / life.quantiles[0].interval.low), 2.0 * half,
              0.1 * half);
  EXPECT_EQ(life.pseudo_failures, (std::vector<double>{300, 340, 400, 410, 480, 520}));
}

// A specimen that does not approach is one that lives longer than it was seen, not one that is not there.
TEST(LifeFromDegradation, OneThatDoesNotApproachMakesLifeLonger) {
  std::mt19937 random(8);
  std::vector<DegradationPath> paths{PathTo(700.0, 600, 0.01, random), PathTo(800.0, 600, 0.01, random)};
  const double of_two = LifeFromDegradation(paths, {0.5}, 0.9).quantiles[0].value;
  DegradationPath level;
  for (int cycle = 1; cycle <= 600; ++cycle) {
    level.cycle.push_back(cycle);
    level.way.push_back(cycle % 2 == 0 ? 0.01 : -0.01);
  }
  paths.push_back(level);
  const DegradationLife life = LifeFromDegradation(paths, {0.5}, 0.9);
  EXPECT_GT(life.quantiles[0].value, 1.02 * of_two);
  EXPECT_EQ(life.pseudo_failures[2], kNever);
  const std::vector<DegradationPath> flat{level, level};
  try {
    LifeFromDegradation(flat, {0.5}, 0.9);
    FAIL();
  } catch (const NoEstimate& error) {
    EXPECT_STREQ(error.what(), "no specimen approaches its limit");
    EXPECT_EQ(error.expected(), "more cycles, or another limit");
  }
}

// Three units each of 40 populations, by laws that had no part in choosing the constants, run for 60 % of
// the median life. Of 90 % intervals 36 hold on the average; three standard errors are 6.
TEST(LifeFromDegradation, CoversWhatItSays) {
  std::mt19937_64 random(21);
  constexpr int kPopulations = 40;
  int b10 = 0;
  int b50 = 0;
  for (int i = 0; i < kPopulations; ++i) {
    const SimulatedPopulation population =
        DrawPopulation(kFiguresOnly[static_cast<std::size_t>(i) % 3], 3, random);
    const double median = population.lives[500];
    std::vector<DegradationPath> seen;
    for (const SimulatedLife& unit : population.units)
      seen.push_back(SeenUntil(unit, static_cast<int>(0.6 * median)));
    const DegradationLife life = LifeFromDegradation(seen, {0.1, 0.5}, 0.9);
    const auto holds = [&](std::size_t i_of, double truth) {
      return life.quantiles[i_of].interval.low <= truth && truth <= life.quantiles[i_of].interval.high;
    };
    b10 += static_cast<int>(holds(0, population.lives[100]));
    b50 += static_cast<int>(holds(1, median));
  }
  EXPECT_GE(b10, 30);
  EXPECT_GE(b50, 30);
}

TEST(LifeFromDegradation, OfOneSpecimenIsNone) {
  std::mt19937 random(6);
  try {
    LifeFromDegradation(std::vector<DegradationPath>{PathTo(1000.0, 100, 0.01, random)}, {0.1}, 0.9);
    FAIL();
  } catch (const NoEstimate& error) {
    EXPECT_STREQ(error.what(), "one specimen tells nothing of how others differ");
    EXPECT_EQ(error.expected(), "two campaigns at least, of different specimens; its own forecast needs one");
  }
}

// By hand: all rise, all end at 4 after a way of 3 or 4, and lines over life correlate fully.
TEST(PrognosticWorth, IsThatOfColbesDefinitions) {
  const std::vector<std::vector<double>> alike{{1, 2, 3, 4}, {0, 2, 4}};
  const PrognosticWorth best = WorthOf(alike);
  EXPECT_NEAR(best.monotonicity, 1.0, 1e-12);
  EXPECT_NEAR(best.prognosability, 1.0, 1e-12);
  EXPECT_NEAR(best.trendability, 1.0, 1e-12);
  // Two rises less one fall of three: 1/3. Last values 2 and 4, σ = √2, mean way (1 + 4)/2.
  const PrognosticWorth other = WorthOf(std::vector<std::vector<double>>{{1, 3, 1, 2}, {0, 2, 4, 4}});
  EXPECT_NEAR(other.monotonicity, 0.5 * (1.0 / 3.0 + 2.0 / 3.0), 1e-12);
  EXPECT_NEAR(other.prognosability, std::exp(-std::sqrt(2.0) / 2.5), 1e-12);
  EXPECT_LT(other.trendability, 0.5);
  EXPECT_THROW(WorthOf(std::vector<std::vector<double>>{{1}}), std::invalid_argument);
}

}  // namespace
}  // namespace strainwave::analysis::reliability::degradation_test
