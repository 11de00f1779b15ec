// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <fstream>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "analysis/statistics/gaussian_process.h"
#include "tests/analysis/golden.h"

// scikit-learn's own values, of one and of three coordinates: GaussianProcessRegressor with a constant times
// a squared exponential and white noise, no mean; docs/sources.md#scikit-learn.
namespace strainwave::analysis::statistics::gaussian_process_golden_test {
namespace {

using Json = nlohmann::json;

Eigen::VectorXd VectorOf(const Json& list) {
  const auto values = list.get<std::vector<double>>();
  return Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
}

Eigen::MatrixXd RowsOf(const Json& list) {
  Eigen::MatrixXd rows(static_cast<Eigen::Index>(list.size()),
                       static_cast<Eigen::Index>(list.front().size()));
  for (Eigen::Index i = 0; i < rows.rows(); ++i) rows.row(i) = VectorOf(list[static_cast<std::size_t>(i)]);
  return rows;
}

// It adds this to the diagonal for the factorisation's sake; to predicted variances it adds the noise alone.
constexpr double kJitter = 1e-10;
constexpr double kTolerance = 1e-8;

GaussianProcessParameters ParametersOf(const Json& log_theta) {
  const Eigen::VectorXd theta = VectorOf(log_theta).array().exp();
  return {theta(0), theta.segment(1, theta.size() - 2), theta(theta.size() - 1) + kJitter};
}

void ExpectPrediction(const GaussianProcess& process, const Json& golden, const Json& points) {
  const Posterior posterior = process.At(RowsOf(points));
  const Eigen::VectorXd mean = VectorOf(golden.at("mean"));
  const Eigen::VectorXd deviation = VectorOf(golden.at("std"));
  const double noise = process.parameters().noise_variance - kJitter;
  for (Eigen::Index i = 0; i < mean.size(); ++i) {
    EXPECT_NEAR(posterior.mean(i), mean(i), kTolerance);
    EXPECT_NEAR(std::sqrt(posterior.covariance(i, i) + noise), deviation(i), kTolerance);
  }
}

TEST(GaussianProcessGolden, EqualsScikitLearn) {
  if (!testing_data::GoldenFolder()) GTEST_SKIP() << testing_data::kNoGolden;
  const Json all = Json::parse(std::ifstream(*testing_data::GoldenFolder() / "gpr_sklearn.json"));
  for (const char* name : {"d1", "d3"}) {
    const Json& golden = all.at(name);
    const ReplicatedData data = Replicated(RowsOf(golden.at("X")), VectorOf(golden.at("y")));
    const GaussianProcessParameters parameters = ParametersOf(golden.at("theta_log"));
    const LogLikelihood likelihood = LogMarginalLikelihood(data, parameters, MeanOf::kZero);
    EXPECT_NEAR(likelihood.value, golden.at("lml").get<double>(), kTolerance) << name;
    const Eigen::VectorXd gradient = VectorOf(golden.at("lml_gradient"));
    ASSERT_EQ(gradient.size(), likelihood.gradient.size());
    for (Eigen::Index k = 0; k < gradient.size(); ++k)
      EXPECT_NEAR(likelihood.gradient(k), gradient(k), kTolerance * std::max(1.0, std::abs(gradient(k))))
          << name;
    ExpectPrediction(GaussianProcess(data, parameters, MeanOf::kZero), golden, golden.at("Xs"));
    ExpectPrediction(GaussianProcess(data, ParametersOf(golden.at("fitted").at("theta_log")), MeanOf::kZero),
                     golden.at("fitted"), golden.at("Xs"));
  }
}

TEST(GaussianProcessGolden, FitIsNoLessLikelyThanScikitLearns) {
  if (!testing_data::GoldenFolder()) GTEST_SKIP() << testing_data::kNoGolden;
  const Json all = Json::parse(std::ifstream(*testing_data::GoldenFolder() / "gpr_sklearn.json"));
  for (const char* name : {"d1", "d3"}) {
    const Json& golden = all.at(name);
    const ReplicatedData data = Replicated(RowsOf(golden.at("X")), VectorOf(golden.at("y")));
    const GaussianProcess fit = FitGaussianProcess(data, {MeanOf::kZero, false, 10, 1});
    EXPECT_GE(fit.log_likelihood(), golden.at("fitted").at("lml").get<double>() - 1e-6) << name;
  }
}

}  // namespace
}  // namespace strainwave::analysis::statistics::gaussian_process_golden_test
