// SPDX-License-Identifier: Apache-2.0
#include "analysis/statistics/random_effects.h"

#include <cmath>
#include <functional>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "tests/analysis/chance.h"
#include "tests/analysis/message_of.h"

namespace strainwave::analysis::statistics::random_effects_test {
namespace {

GroupEstimate Scalar(double value, double standard_error) {
  return {Eigen::VectorXd::Constant(1, value),
          Eigen::MatrixXd::Constant(1, 1, standard_error * standard_error)};
}

GroupEstimate Plane(double x, double y, double standard_error) {
  return {Eigen::Vector2d(x, y), Eigen::Matrix2d::Identity() * standard_error * standard_error};
}

// Equal errors s: Q(τ²) = S / (s² + τ²) with S the sum of squares about the plain mean, so that every number
// has a closed form. Quantiles 0.025 and 0.975 of χ² with 3 degrees of freedom from printed tables.
TEST(RandomEffects, OfEqualErrorsHaveClosedForms) {
  const std::vector<GroupEstimate> groups{Scalar(1.0, 0.5), Scalar(4.0, 0.5), Scalar(2.0, 0.5),
                                          Scalar(5.0, 0.5)};
  const RandomEffects effects = FitRandomEffects(groups);
  constexpr double kSquares = 10.0;  // 4 + 1 + 1 + 4 about the mean of 3
  EXPECT_NEAR(effects.mean(0), 3.0, 1e-12);
  EXPECT_NEAR(effects.q, kSquares / 0.25, 1e-9);
  EXPECT_EQ(effects.degrees_of_freedom, 3);
  EXPECT_NEAR(effects.tau, std::sqrt(kSquares / 3.0 - 0.25), 1e-9);
  EXPECT_NEAR(effects.tau_of_moments, effects.tau, 1e-9);
  constexpr double kRoundingOfTables = 1e-4;
  EXPECT_NEAR(effects.tau_low, std::sqrt(kSquares / 9.34840 - 0.25), kRoundingOfTables);
  EXPECT_NEAR(effects.tau_high, std::sqrt(kSquares / 0.215795 - 0.25), kRoundingOfTables);
  EXPECT_NEAR(effects.mean_covariance(0, 0), kSquares / 3.0 / 4.0, 1e-9);
  // t = 3 / √(10/12) = 3.286 of 3 degrees of freedom; its chance by the closed form of that t.
  const double t = 3.0 / std::sqrt(kSquares / 12.0);
  const double inside = std::atan(t / std::sqrt(3.0)) + t / std::sqrt(3.0) / (1.0 + t * t / 3.0);
  EXPECT_NEAR(effects.mean_p, 1.0 - 2.0 / 3.14159265358979 * inside, 1e-9);
  // χ² of 3 degrees of freedom: erfc(√(x/2)) + √(2x/π) e^(−x/2).
  EXPECT_NEAR(effects.homogeneity_p,
              std::erfc(std::sqrt(20.0)) + std::sqrt(80.0 / 3.14159265358979) * std::exp(-20.0), 1e-15);
}

// Two components: twice the degrees of freedom, here 4, where χ² has 1 − e^(−x/2) (1 + x/2).
TEST(RandomEffects, OfVectorsCountEachComponent) {
  const std::vector<GroupEstimate> groups{Plane(1.0, 0.0, 0.1), Plane(-1.0, 0.0, 0.1), Plane(0.0, 3.0, 0.1)};
  const RandomEffects effects = FitRandomEffects(groups);
  EXPECT_EQ(effects.degrees_of_freedom, 4);
  constexpr double kSquares = 2.0 + 6.0;
  EXPECT_NEAR(effects.mean(0), 0.0, 1e-12);
  EXPECT_NEAR(effects.mean(1), 1.0, 1e-12);
  EXPECT_NEAR(effects.tau, std::sqrt(kSquares / 4.0 - 0.01), 1e-9);
  EXPECT_NEAR(effects.tau_of_moments, effects.tau, 1e-9);
  const double high = kSquares / (effects.tau_high * effects.tau_high + 0.01);
  const double low = kSquares / (effects.tau_low * effects.tau_low + 0.01);
  EXPECT_NEAR(1.0 - std::exp(-0.5 * high) * (1.0 + 0.5 * high), 0.025, 1e-9);
  EXPECT_NEAR(std::exp(-0.5 * low) * (1.0 + 0.5 * low), 0.025, 1e-9);
}

// A number per group with errors of all sizes; by another route: a fine grid instead of roots, sums instead
// of matrices, and DerSimonian and Laird's formula as it is printed.
TEST(RandomEffects, OfUnequalErrorsAgreeWithSumsOnAGrid) {
  const double values[] = {0.31, 0.07, 0.52, 0.24, 0.90, 0.43};
  const double errors[] = {0.05, 0.11, 0.20, 0.02, 0.31, 0.09};
  std::vector<GroupEstimate> groups;
  for (int i = 0; i < 6; ++i) groups.push_back(Scalar(values[i], errors[i]));
  const RandomEffects effects = FitRandomEffects(groups);
  struct Sums {
    double weights{}, squares{}, mean{}, q{};
  };
  const auto at = [&](double tau_square) {
    Sums sums;
    double weighted = 0.0;
    for (int i = 0; i < 6; ++i) {
      const double weight = 1.0 / (errors[i] * errors[i] + tau_square);
      sums.weights += weight;
      sums.squares += weight * weight;
      weighted += weight * values[i];
    }
    sums.mean = weighted / sums.weights;
    for (int i = 0; i < 6; ++i)
      sums.q += std::pow(values[i] - sums.mean, 2) / (errors[i] * errors[i] + tau_square);
    return sums;
  };
  const auto tau_at = [&](double level) {
    double tau = 0.0;
    while (at(tau * tau).q > level) tau += 1e-5;
    return tau;
  };
  // Quantiles of χ² with 5 degrees of freedom from printed tables.
  constexpr double kGrid = 3e-5;
  EXPECT_NEAR(effects.tau, tau_at(5.0), kGrid);
  EXPECT_NEAR(effects.tau_low, tau_at(12.8325), kGrid);
  EXPECT_NEAR(effects.tau_high, tau_at(0.831212), 2.0 * kGrid);
  const Sums fixed = at(0.0);
  EXPECT_NEAR(effects.q, fixed.q, 1e-9);
  const double moments = std::max(0.0, (fixed.q - 5.0) / (fixed.weights - fixed.squares / fixed.weights));
  EXPECT_NEAR(effects.tau_of_moments, std::sqrt(moments), 1e-9);
  const Sums random = at(effects.tau * effects.tau);
  EXPECT_NEAR(effects.mean(0), random.mean, 1e-9);
  EXPECT_NEAR(effects.mean_covariance(0, 0), 1.0 / random.weights, 1e-12);
}

TEST(RandomEffects, OfGroupsThatAreAlikeHaveNoSpread) {
  const std::vector<GroupEstimate> groups{Scalar(1.0, 0.5), Scalar(1.4, 0.5), Scalar(0.8, 0.5)};
  const RandomEffects effects = FitRandomEffects(groups);
  EXPECT_EQ(effects.tau, 0.0);
  EXPECT_EQ(effects.tau_low, 0.0);
  EXPECT_GT(effects.tau_high, 0.5);
  EXPECT_GT(effects.homogeneity_p, 0.5);
}

// Turning all vectors turns the mean alone, with errors that differ by direction, too.
TEST(RandomEffects, DoNotDependOnTheAxes) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  std::vector<GroupEstimate> groups;
  std::vector<GroupEstimate> turned;
  Eigen::Matrix2d turn;
  turn << 0.6, -0.8, 0.8, 0.6;
  for (int i = 0; i < 5; ++i) {
    Eigen::Matrix2d root;
    root << 1.0, 0.3 * normal(random), 0.0, 0.2 + std::abs(normal(random));
    const Eigen::Vector2d value(2.0 + normal(random), normal(random));
    groups.push_back({value, root * root.transpose()});
    turned.push_back({turn * value, turn * root * root.transpose() * turn.transpose()});
  }
  const RandomEffects one = FitRandomEffects(groups);
  const RandomEffects other = FitRandomEffects(turned);
  EXPECT_NEAR(one.tau, other.tau, 1e-9);
  EXPECT_NEAR(one.tau_high, other.tau_high, 1e-9);
  EXPECT_NEAR(one.mean_p, other.mean_p, 1e-9);
  EXPECT_NEAR((turn * one.mean - other.mean).norm(), 0.0, 1e-9);
}

// Draws of so many groups with errors from 0.05 to 0.5: how often the interval holds τ, and
// how often a mean of zero is called away from it at 5 %.
struct Drawn {
  int held{};
  int away{};
};
Drawn Draw(int groups, double tau, int components, unsigned seed, int trials) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  Drawn drawn;
  for (int trial = 0; trial < trials; ++trial) {
    std::vector<GroupEstimate> estimates;
    for (int i = 0; i < groups; ++i) {
      const double error = 0.05 + 0.45 * i / (groups - 1.0);
      const double spread = std::hypot(error, tau);
      estimates.push_back(components == 1 ? Scalar(spread * normal(random), error)
                                          : Plane(spread * normal(random), spread * normal(random), error));
    }
    const RandomEffects effects = FitRandomEffects(estimates);
    drawn.held += effects.tau_low <= tau && tau <= effects.tau_high ? 1 : 0;
    drawn.away += effects.mean_p < 0.05 ? 1 : 0;
  }
  return drawn;
}

// The interval inverts an exact test: its coverage is 95 % whatever the number of groups, their errors and τ.
TEST(RandomEffects, IntervalsHoldTheirDeviationNinetyFiveTimesOfAHundred) {
  constexpr int kTrials = 2000;
  unsigned seed = 1;
  for (const int groups : {3, 5, 10}) {
    for (const int components : {1, 2}) {
      for (const double tau : {0.1, 0.5}) {
        SCOPED_TRACE(testing::Message() << groups << " groups, " << components << " components, τ " << tau);
        const Drawn drawn = Draw(groups, tau, components, seed++, kTrials);
        ExpectCoverageOf95(drawn.held, kTrials);
      }
    }
  }
}

// At τ = 0 the lower end alone can miss it: 97.5 %.
TEST(RandomEffects, IntervalsBeginAtZeroWhereGroupsAreAlike) {
  constexpr int kTrials = 2000;
  for (const int groups : {3, 5, 10}) {
    std::mt19937 random(50 + static_cast<unsigned>(groups));
    std::normal_distribution<double> normal;
    int begin_at_zero = 0;
    for (int trial = 0; trial < kTrials; ++trial) {
      std::vector<GroupEstimate> estimates;
      for (int i = 0; i < groups; ++i) {
        const double error = 0.05 + 0.45 * i / (groups - 1.0);
        estimates.push_back(Plane(1.0 + error * normal(random), error * normal(random), error));
      }
      begin_at_zero += FitRandomEffects(estimates).tau_low == 0.0 ? 1 : 0;
    }
    SCOPED_TRACE(groups);
    ExpectShare(begin_at_zero, kTrials, 0.975);
  }
}

// The test of the mean is exact where errors are small beside τ. Where errors differ tenfold and τ is as
// small as the smallest the estimate of τ is often zero, and up to 13 of 100 (261 of these 2000) are called
// away.
TEST(RandomEffects, SeldomCallAMeanOfZeroAwayFromIt) {
  constexpr int kTrials = 2000;
  unsigned seed = 100;
  for (const int groups : {3, 5, 10}) {
    for (const int components : {1, 2}) {
      SCOPED_TRACE(testing::Message() << groups << " groups, " << components << " components");
      ExpectShare(Draw(groups, 20.0, components, seed++, kTrials).away, kTrials, 0.05);
      EXPECT_LE(Draw(groups, 0.1, components, seed++, kTrials).away, 0.15 * kTrials);
    }
  }
}

// Of equal errors what is expected is what the closed form says of a spread as it is expected.
TEST(ExpectedTauInterval, NarrowsWithTheGroups) {
  const ExpectedInterval four = ExpectedTauInterval(std::sqrt(10.0 / 3.0 - 0.25), 0.5, 4, 1);
  EXPECT_NEAR(four.low, std::sqrt(10.0 / 9.34840 - 0.25), 1e-4);
  EXPECT_NEAR(four.high, std::sqrt(10.0 / 0.215795 - 0.25), 1e-4);
  const ExpectedInterval forty = ExpectedTauInterval(std::sqrt(10.0 / 3.0 - 0.25), 0.5, 40, 1);
  EXPECT_GT(forty.low, four.low);
  EXPECT_LT(forty.high, four.high);
}

TEST(RandomEffects, SayWhatIsWrong) {
  const auto message = [](const std::vector<GroupEstimate>& groups) {
    return MessageOf([&] { FitRandomEffects(groups); });
  };
  EXPECT_EQ(message({Scalar(1.0, 0.5)}), "1 groups (expected two or more)");
  EXPECT_EQ(message({Scalar(1.0, 0.5), Plane(1.0, 0.0, 0.5)}),
            "estimates of groups differ in their number of components");
  EXPECT_EQ(message({Scalar(1.0, 0.5), Scalar(NAN, 0.5)}), "an estimate of a group is not finite");
  EXPECT_EQ(message({Scalar(1.0, 0.5), Scalar(1.0, 0.0)}),
            "the covariance of a group is not positive definite");
}

}  // namespace
}  // namespace strainwave::analysis::statistics::random_effects_test
