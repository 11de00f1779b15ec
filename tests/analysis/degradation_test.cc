// SPDX-License-Identifier: Apache-2.0
#include "analysis/reliability/degradation.h"

#include <cmath>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "analysis/reliability/prognostic_features.h"

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

// Lives are lognormal about 1000 cycles with a known spread, half of them seen: B10 and B50 come back.
TEST(LifeFromDegradation, RecoversALognormalPopulation) {
  std::mt19937 random(4);
  std::normal_distribution<double> normal;
  std::vector<DegradationPath> paths;
  constexpr double kSpread = 0.2;
  for (int i = 0; i < 12; ++i)
    paths.push_back(PathTo(1000.0 * std::exp(kSpread * normal(random)), 400, 0.01, random));
  const DegradationLife life = LifeFromDegradation(paths, {0.1, 0.5}, 0.9);
  const double b10 = 1000.0 * std::exp(-1.2816 * kSpread);
  EXPECT_LT(life.quantiles[0].likelihood_ratio.low, b10);
  EXPECT_GT(life.quantiles[0].likelihood_ratio.high, b10);
  EXPECT_LT(life.quantiles[1].likelihood_ratio.low, 1000.0);
  EXPECT_GT(life.quantiles[1].likelihood_ratio.high, 1000.0);
  EXPECT_NEAR(life.noise, 0.01 / std::sqrt(5.0), 0.0005);  // five cycles a point
  EXPECT_NEAR(life.power, kPower, 0.05);
  EXPECT_EQ(life.pseudo_failures.size(), 12U);
}

TEST(LifeFromDegradation, NeverHasANegativeLife) {
  std::mt19937 random(5);
  const std::vector<DegradationPath> paths{PathTo(100.0, 40, 0.02, random), PathTo(300.0, 40, 0.02, random),
                                           PathTo(900.0, 40, 0.02, random)};
  const DegradationLife life = LifeFromDegradation(paths, {0.1}, 0.9);
  EXPECT_GE(life.quantiles[0].likelihood_ratio.low, 0.0);
  EXPECT_GE(life.quantiles[0].fisher.low, 0.0);
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
