// SPDX-License-Identifier: Apache-2.0
#include "analysis/statistics/gaussian_process.h"

#include <cmath>
#include <map>
#include <numbers>
#include <stdexcept>

#include <fmt/format.h>

#include "analysis/arguments.h"
#include "analysis/decompositions.h"
#include "analysis/units.h"

namespace strainwave::analysis::statistics {
namespace {

void RequireParameters(const ReplicatedData& data, const GaussianProcessParameters& parameters) {
  RequirePositive("signal_variance", parameters.signal_variance);
  RequirePositive("noise_variance", parameters.noise_variance);
  if (parameters.length.size() != data.points.cols())
    throw std::invalid_argument(fmt::format("{} lengths for {} coordinates (expected one each)",
                                            parameters.length.size(), data.points.cols()));
  for (const double length : parameters.length) RequirePositive("length", length);
}

// σf² exp(−½ Σ …) of all pairs.
Eigen::MatrixXd Kernel(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b,
                       const GaussianProcessParameters& parameters) {
  Eigen::MatrixXd kernel(a.rows(), b.rows());
  for (Eigen::Index j = 0; j < b.rows(); ++j) {
    for (Eigen::Index i = 0; i < a.rows(); ++i) {
      const double square =
          ((a.row(i) - b.row(j)).transpose().array() / parameters.length.array()).square().sum();
      kernel(i, j) = parameters.signal_variance * std::exp(-0.5 * square);
    }
  }
  return kernel;
}

// Of the covariance of the means of the groups.
struct Inverted {
  Eigen::MatrixXd kernel;
  Eigen::MatrixXd inverse;
  double log_determinant{};
};
Inverted Invert(const ReplicatedData& data, const GaussianProcessParameters& parameters) {
  Inverted inverted;
  inverted.kernel = Kernel(data.points, data.points, parameters);
  Eigen::MatrixXd covariance = inverted.kernel;
  covariance.diagonal().array() += parameters.noise_variance / data.counts.array();
  const Eigen::MatrixXd lower = InverseCholesky(covariance);
  inverted.log_determinant = -2.0 * lower.diagonal().array().log().sum();
  if (!std::isfinite(inverted.log_determinant))
    throw std::domain_error("the covariance of the measurements is singular (expected more noise)");
  inverted.inverse = lower.transpose() * lower;
  return inverted;
}

double MeanAt(const ReplicatedData& data, const Eigen::MatrixXd& inverse, MeanOf mean) {
  if (mean == MeanOf::kZero) return 0.0;
  return (inverse * data.means).sum() / inverse.sum();
}

}  // namespace

ReplicatedData Replicated(const Eigen::MatrixXd& points, const Eigen::VectorXd& values) {
  if (points.rows() != values.size() || points.cols() < 1 || values.size() < 1)
    throw std::invalid_argument(
        fmt::format("{} values at {} places of {} coordinates (expected one each, of one "
                    "coordinate or more)",
                    values.size(), points.rows(), points.cols()));
  std::map<std::vector<double>, std::vector<double>> groups;
  for (Eigen::Index i = 0; i < points.rows(); ++i) {
    const Eigen::VectorXd point = points.row(i);
    RequireFinite("places", std::span<const double>(point.data(), static_cast<std::size_t>(point.size())));
    RequireFinite("values", values(i));
    groups[{point.begin(), point.end()}].push_back(values(i));
  }
  const auto count = static_cast<Eigen::Index>(groups.size());
  ReplicatedData data{Eigen::MatrixXd(count, points.cols()), Eigen::VectorXd(count), Eigen::VectorXd(count),
                      0.0};
  Eigen::Index at = 0;
  for (const auto& [point, members] : groups) {
    data.points.row(at) = Eigen::Map<const Eigen::RowVectorXd>(point.data(), points.cols());
    const Eigen::Map<const Eigen::VectorXd> all(members.data(), static_cast<Eigen::Index>(members.size()));
    data.means(at) = all.mean();
    data.counts(at) = static_cast<double>(members.size());
    data.within += (all.array() - all.mean()).square().sum();
    ++at;
  }
  return data;
}

LogLikelihood LogMarginalLikelihood(const ReplicatedData& data, const GaussianProcessParameters& parameters,
                                    MeanOf mean, bool one_length) {
  RequireParameters(data, parameters);
  const Inverted inverted = Invert(data, parameters);
  const double m = MeanAt(data, inverted.inverse, mean);
  const Eigen::VectorXd off = data.means.array() - m;
  const Eigen::VectorXd weights = inverted.inverse * off;
  const double more = data.size() - static_cast<double>(data.means.size());
  const double noise = parameters.noise_variance;
  const double groups = static_cast<double>(data.means.size());
  LogLikelihood result;
  result.value = -0.5 * off.dot(weights) - 0.5 * inverted.log_determinant - 0.5 * groups * std::log(kTwoPi) -
                 0.5 * more * std::log(kTwoPi * noise) - 0.5 * data.within / noise -
                 0.5 * data.counts.array().log().sum();
  // ½ tr((w wᵀ − C⁻¹) dC), and what the groups' own scatter says of the noise.
  const Eigen::MatrixXd slope = weights * weights.transpose() - inverted.inverse;
  const Eigen::Index d = data.points.cols();
  result.gradient = Eigen::VectorXd::Zero(d + 2);
  result.gradient(0) = 0.5 * slope.cwiseProduct(inverted.kernel).sum();
  for (Eigen::Index k = 0; k < d; ++k) {
    const Eigen::VectorXd x = data.points.col(k) / parameters.length(k);
    const Eigen::MatrixXd square =
        (x.replicate(1, x.size()) - x.transpose().replicate(x.size(), 1)).array().square();
    result.gradient(1 + k) = 0.5 * slope.cwiseProduct(inverted.kernel).cwiseProduct(square).sum();
  }
  result.gradient(d + 1) = 0.5 * (slope.diagonal().array() * noise / data.counts.array()).sum() - 0.5 * more +
                           0.5 * data.within / noise;
  if (one_length) {
    Eigen::VectorXd shorter(3);
    shorter << result.gradient(0), result.gradient.segment(1, d).sum(), result.gradient(d + 1);
    result.gradient = shorter;
  }
  return result;
}

GaussianProcess::GaussianProcess(ReplicatedData data, GaussianProcessParameters parameters, MeanOf mean)
    : data_(std::move(data)), parameters_(std::move(parameters)), mean_of_(mean) {
  RequireParameters(data_, parameters_);
  log_likelihood_ = LogMarginalLikelihood(data_, parameters_, mean).value;
  inverse_ = Invert(data_, parameters_).inverse;
  mean_ = MeanAt(data_, inverse_, mean);
  weights_ = inverse_ * (data_.means.array() - mean_).matrix();
}

Posterior GaussianProcess::At(const Eigen::MatrixXd& points) const {
  const Eigen::MatrixXd cross = Kernel(points, data_.points, parameters_);
  Posterior posterior;
  posterior.mean = (cross * weights_).array() + mean_;
  posterior.covariance = Kernel(points, points, parameters_) - cross * inverse_ * cross.transpose();
  if (mean_of_ == MeanOf::kConstant) {
    const Eigen::VectorXd left = 1.0 - (cross * inverse_.rowwise().sum()).array();
    posterior.covariance += left * left.transpose() / inverse_.sum();
  }
  return posterior;
}

}  // namespace strainwave::analysis::statistics
