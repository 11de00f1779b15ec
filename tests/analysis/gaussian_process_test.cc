// SPDX-License-Identifier: Apache-2.0
#include "analysis/statistics/gaussian_process.h"

#include <cmath>
#include <random>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/Dense>

#include "tests/analysis/chance.h"

namespace strainwave::analysis::statistics::gaussian_process_test {
namespace {

struct Measured {
  Eigen::MatrixXd points;
  Eigen::VectorXd values;
};

// Some points are measured several times.
Measured Measurements(Eigen::Index count, Eigen::Index coordinates, std::uint64_t seed, int repeats = 1) {
  std::mt19937_64 engine(seed);
  std::uniform_real_distribution<double> even(0.0, 10.0);
  std::normal_distribution<double> normal;
  Measured measured{Eigen::MatrixXd(count, coordinates), Eigen::VectorXd(count)};
  for (Eigen::Index i = 0; i < count; ++i) {
    if (i % repeats == 0) {
      for (Eigen::Index k = 0; k < coordinates; ++k) measured.points(i, k) = even(engine);
    } else {
      measured.points.row(i) = measured.points.row(i - 1);
    }
    measured.values(i) = 2.0 + std::sin(measured.points(i, 0)) + 0.3 * measured.points(i, coordinates - 1) +
                         0.1 * normal(engine);
  }
  return measured;
}

GaussianProcessParameters SomeParameters(Eigen::Index coordinates) {
  Eigen::VectorXd length(coordinates);
  for (Eigen::Index k = 0; k < coordinates; ++k) length(k) = 1.7 + 0.9 * static_cast<double>(k);
  return {1.3, length, 0.07};
}

// By another route: the density of all measurements with their full covariance, in long double by LU.
double LogDensity(const Measured& measured, const GaussianProcessParameters& parameters, MeanOf mean) {
  using Matrix = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;
  const Eigen::Index n = measured.values.size();
  Matrix covariance(n, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index j = 0; j < n; ++j) {
      long double square = 0.0L;
      for (Eigen::Index k = 0; k < measured.points.cols(); ++k) {
        const long double off = measured.points(i, k) - measured.points(j, k);
        square += off * off / (static_cast<long double>(parameters.length(k)) * parameters.length(k));
      }
      covariance(i, j) =
          parameters.signal_variance * std::exp(-0.5L * square) + (i == j ? parameters.noise_variance : 0.0);
    }
  }
  const Eigen::FullPivLU<Matrix> factor(covariance);
  const Matrix ones = Matrix::Ones(n, 1);
  Matrix y = measured.values.cast<long double>();
  if (mean == MeanOf::kConstant) {
    const Matrix inverse_ones = factor.solve(ones);
    y -= ones * ((inverse_ones.transpose() * y)(0, 0) / inverse_ones.sum());
  }
  const long double quadratic = (y.transpose() * factor.solve(y))(0, 0);
  long double log_determinant = 0.0L;
  for (Eigen::Index i = 0; i < n; ++i) log_determinant += std::log(std::abs(factor.matrixLU()(i, i)));
  return static_cast<double>(
      -0.5L * (quadratic + log_determinant +
               static_cast<long double>(n) * std::log(2.0L * 3.14159265358979323846264338327950288L)));
}

TEST(GaussianProcess, LikelihoodIsTheDensityOfAllMeasurements) {
  for (const int repeats : {1, 5}) {
    for (const MeanOf mean : {MeanOf::kZero, MeanOf::kConstant}) {
      const Measured measured = Measurements(30, 2, 4, repeats);
      const GaussianProcessParameters parameters = SomeParameters(2);
      const ReplicatedData data = Replicated(measured.points, measured.values);
      EXPECT_EQ(data.means.size(), 30 / repeats);
      EXPECT_NEAR(LogMarginalLikelihood(data, parameters, mean).value, LogDensity(measured, parameters, mean),
                  1e-9);
    }
  }
}

TEST(GaussianProcess, GradientIsThatOfDifferences) {
  constexpr double kStep = 1e-5;
  const Measured measured = Measurements(24, 2, 9, 2);
  const ReplicatedData data = Replicated(measured.points, measured.values);
  const GaussianProcessParameters at = SomeParameters(2);
  for (const MeanOf mean : {MeanOf::kZero, MeanOf::kConstant}) {
    const Eigen::VectorXd gradient = LogMarginalLikelihood(data, at, mean).gradient;
    ASSERT_EQ(gradient.size(), 4);
    for (Eigen::Index k = 0; k < 4; ++k) {
      const auto value = [&](double step) {
        GaussianProcessParameters moved = at;
        double& number = k == 0 ? moved.signal_variance : k == 3 ? moved.noise_variance : moved.length(k - 1);
        number *= std::exp(step);
        return LogMarginalLikelihood(data, moved, mean).value;
      };
      EXPECT_NEAR(gradient(k), (value(kStep) - value(-kStep)) / (2.0 * kStep), 1e-6) << k;
    }
    const Eigen::VectorXd one = LogMarginalLikelihood(data, at, mean, true).gradient;
    ASSERT_EQ(one.size(), 3);
    EXPECT_NEAR(one(1), gradient(1) + gradient(2), 1e-12);
  }
}

// The profile is the full likelihood at the best σf², and its slope that of differences.
TEST(GaussianProcess, ProfileIsTheFullLikelihoodAtTheBestSignal) {
  const Measured measured = Measurements(30, 2, 11, 3);
  const ReplicatedData data = Replicated(measured.points, measured.values);
  for (const bool one_length : {false, true}) {
    ProfileLikelihood profile(data, MeanOf::kConstant, one_length);
    Eigen::VectorXd at(profile.parameter_count());
    at.setConstant(std::log(1.9));
    at(at.size() - 1) = std::log(0.05);
    Eigen::VectorXd slope;
    const double value = profile.Compute(at, slope);
    GaussianProcessParameters parameters;
    parameters.signal_variance = profile.signal_variance();
    parameters.noise_variance = 0.05 * parameters.signal_variance;
    parameters.length = Eigen::VectorXd::Constant(2, 1.9);
    const LogLikelihood full = LogMarginalLikelihood(data, parameters, MeanOf::kConstant);
    EXPECT_NEAR(value, full.value, 1e-9);
    // Signal and noise together do not change the ratio: there the profile is flat.
    EXPECT_NEAR(full.gradient(0) + full.gradient(3), 0.0, 1e-9);
    constexpr double kStep = 1e-5;
    for (Eigen::Index k = 0; k < at.size(); ++k) {
      Eigen::VectorXd moved = at;
      Eigen::VectorXd unused;
      moved(k) = at(k) + kStep;
      const double above = profile.Compute(moved, unused);
      moved(k) = at(k) - kStep;
      EXPECT_NEAR(slope(k), (above - profile.Compute(moved, unused)) / (2.0 * kStep), 1e-5) << k;
    }
  }
}

TEST(GaussianProcess, FitHasNoSlopeLeftAndFindsTheNoise) {
  const Measured measured = Measurements(120, 1, 3);
  const GaussianProcess fit = FitGaussianProcess(Replicated(measured.points, measured.values), {});
  const LogLikelihood at = LogMarginalLikelihood(fit.data(), fit.parameters(), MeanOf::kConstant);
  constexpr double kFlat = 1e-3;  // of a log-likelihood, by logarithms: what no test of it could tell
  for (const double slope : at.gradient) EXPECT_NEAR(slope, 0.0, kFlat);
  // 120 values less some twenty that a smooth surface takes.
  EXPECT_NEAR(std::sqrt(fit.parameters().noise_variance), 0.1, kByChance * SpreadOfDeviation(100.0) * 0.1);
}

TEST(GaussianProcess, PosteriorGoesThroughMeansThatAreKnownWell) {
  Eigen::MatrixXd points(4, 1);
  points << 0, 1, 2, 3;
  Eigen::VectorXd values(4);
  values << 1, 3, 2, 5;
  const GaussianProcess surface(Replicated(points, values), {4.0, Eigen::VectorXd::Constant(1, 1.0), 1e-8},
                                MeanOf::kConstant);
  const Posterior there = surface.At(points);
  for (Eigen::Index i = 0; i < 4; ++i) {
    EXPECT_NEAR(there.mean(i), values(i), 1e-6);
    EXPECT_NEAR(there.covariance(i, i), 0.0, 1e-7);
  }
  // Far away it is the mean, with the whole variance and what is not known of the mean.
  const Posterior far = surface.At(Eigen::MatrixXd::Constant(1, 1, 1e3));
  EXPECT_NEAR(far.mean(0), surface.mean(), 1e-9);
  EXPECT_GT(far.covariance(0, 0), 4.0);
}

std::string MessageOf(const Measured& measured, const GaussianProcessParameters& parameters) {
  try {
    LogMarginalLikelihood(Replicated(measured.points, measured.values), parameters, MeanOf::kZero);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

TEST(GaussianProcess, RefusesWhatItCannotUse) {
  const Measured measured = Measurements(5, 2, 1);
  GaussianProcessParameters parameters = SomeParameters(2);
  parameters.noise_variance = 0.0;
  EXPECT_EQ(MessageOf(measured, parameters), "noise_variance = 0 is not a positive number");
  EXPECT_EQ(MessageOf(measured, SomeParameters(1)), "1 lengths for 2 coordinates (expected one each)");
  const Eigen::VectorXd same = Eigen::VectorXd::Ones(5);
  EXPECT_THROW(FitGaussianProcess(Replicated(measured.points, same), {}), std::invalid_argument);
}

}  // namespace
}  // namespace strainwave::analysis::statistics::gaussian_process_test
