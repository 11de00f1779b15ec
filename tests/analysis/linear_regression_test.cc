// SPDX-License-Identifier: Apache-2.0
#include "analysis/linear_regression.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "analysis/autocorrelation.h"
#include "tests/analysis/message_of.h"

namespace strainwave::analysis::linear_regression_test {
namespace {

Eigen::VectorXd AutoregressiveNoise(Eigen::Index n, double rho, std::uint32_t seed) {
  std::mt19937 engine(seed);
  std::normal_distribution<double> normal;
  Eigen::VectorXd noise(n);
  double state = normal(engine);
  for (double& value : noise) {
    value = state;
    state = rho * state + std::sqrt(1.0 - rho * rho) * normal(engine);
  }
  return noise;
}

// NIST StRD "Norris": certified slope, offset, their standard deviations and the residual's.
TEST(FitLinear, AgreesWithTheCertifiedValuesOfNorris) {
  const double y[] = {0.1, 338.8, 118.1, 888.0, 9.2,   228.1, 668.5, 998.5, 449.1, 778.9, 559.2, 0.3,
                      0.1, 778.1, 668.8, 339.3, 448.9, 10.8,  557.7, 228.3, 998.0, 888.8, 119.6, 0.3,
                      0.6, 557.6, 339.3, 888.0, 998.5, 778.9, 10.2,  117.6, 228.9, 668.4, 449.2, 0.2};
  const double x[] = {0.2, 337.4, 118.2, 884.6, 10.1,  226.5, 666.3, 996.3, 448.6, 777.0, 558.2, 0.4,
                      0.6, 775.5, 666.9, 338.0, 447.5, 11.6,  556.0, 228.1, 995.8, 887.6, 120.2, 0.3,
                      0.3, 556.8, 339.1, 887.2, 999.0, 779.0, 11.1,  118.3, 229.2, 669.1, 448.9, 0.5};
  Eigen::MatrixXd design(36, 2);
  Eigen::VectorXd values(36);
  for (Eigen::Index i = 0; i < 36; ++i) {
    design.row(i) << 1.0, x[i];
    values(i) = y[i];
  }
  const LinearFit fit = FitLinear(design, values, ErrorModel::kIndependent);
  EXPECT_NEAR(fit.coefficients(0), -0.262323073774029, 1e-11);
  EXPECT_NEAR(fit.coefficients(1), 1.00211681802045, 1e-13);
  EXPECT_NEAR(fit.StandardError(0), 0.232818234301152, 1e-10);
  EXPECT_NEAR(fit.StandardError(1), 0.429796848199937e-03, 1e-13);
  EXPECT_NEAR(fit.residual_standard_deviation, 0.884796396144373, 1e-11);
}

TEST(FitLinear, GivesAColumnThatOthersMakeUpNoVariance) {
  Eigen::MatrixXd design(10, 3);
  for (Eigen::Index i = 0; i < 10; ++i) {
    design.row(i) << 1.0, static_cast<double>(i), 2.0 * static_cast<double>(i);
  }
  const Eigen::VectorXd y = design.col(1);
  const LinearFit fit = FitLinear(design, y, ErrorModel::kAutocorrelated);
  EXPECT_EQ(fit.rank, 2);
  EXPECT_LT(fit.residuals.norm(), 1e-12);
  EXPECT_TRUE(fit.covariance.allFinite());
}

TEST(FitLinear, ItsErrorsCoverTheTruthUnderColouredNoise) {
  for (const double rho : {0.0, 0.5, 0.8}) {
    int robust = 0;
    int naive = 0;
    constexpr int kTrials = 400;
    for (std::uint32_t seed = 1; seed <= kTrials; ++seed) {
      constexpr Eigen::Index kSamples = 500;
      Eigen::MatrixXd design(kSamples, 2);
      for (Eigen::Index i = 0; i < kSamples; ++i) {
        design.row(i) << 1.0, std::sin(0.02 * static_cast<double>(i));
      }
      const Eigen::VectorXd y = 3.0 * design.col(1) + AutoregressiveNoise(kSamples, rho, seed);
      const LinearFit fit = FitLinear(design, y, ErrorModel::kAutocorrelated);
      robust += std::abs(fit.coefficients(1) - 3.0) < 1.96 * fit.StandardError(1) ? 1 : 0;
      const LinearFit other = FitLinear(design, y, ErrorModel::kIndependent);
      naive += std::abs(other.coefficients(1) - 3.0) < 1.96 * other.StandardError(1) ? 1 : 0;
    }
    EXPECT_GE(robust, 0.90 * kTrials) << rho;
    EXPECT_LE(robust, 0.99 * kTrials) << rho;
    if (rho == 0.8) {
      EXPECT_LT(naive, 0.65 * kTrials);  // what it is good for
    }
  }
}

TEST(FitLinear, RefusesMoreColumnsThanRows) {
  EXPECT_EQ(MessageOf([] {
              FitLinear(Eigen::MatrixXd::Ones(2, 3), Eigen::VectorXd::Ones(2), ErrorModel::kIndependent);
            }),
            "design has 2 rows (expected at least as many as its 3 columns)");
  EXPECT_EQ(MessageOf([] {
              FitLinear(Eigen::MatrixXd::Ones(4, 1), Eigen::VectorXd::Ones(3), ErrorModel::kIndependent);
            }),
            "y has 3 values, design has 4 rows (expected the same number)");
}

TEST(LongRunCovariance, IsTheBartlettSumOfAutocovariances) {
  const Eigen::VectorXd x = AutoregressiveNoise(50, 0.6, 3);
  constexpr Eigen::Index kBandwidth = 7;
  double expected = 0.0;
  for (Eigen::Index lag = -(kBandwidth - 1); lag < kBandwidth; ++lag) {
    const double weight = 1.0 - std::abs(static_cast<double>(lag)) / kBandwidth;
    for (Eigen::Index i = 0; i < 50; ++i) {
      expected += i + lag >= 0 && i + lag < 50 ? weight * x(i) * x(i + lag) : 0.0;
    }
  }
  EXPECT_NEAR(LongRunCovariance(x, kBandwidth)(0, 0), expected, 1e-10);
}

TEST(VarianceInflation, IsThatOfAFirstOrderAutoregression) {
  const Eigen::VectorXd x = AutoregressiveNoise(100000, 0.5, 4);
  EXPECT_NEAR(VarianceInflation({x.data(), static_cast<std::size_t>(x.size())}), (1.0 + 0.5) / (1.0 - 0.5),
              0.3);
}

}  // namespace
}  // namespace strainwave::analysis::linear_regression_test
