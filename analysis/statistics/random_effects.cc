// SPDX-License-Identifier: Apache-2.0
#include "analysis/statistics/random_effects.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <stdexcept>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/tools/roots.hpp>

#include "analysis/decompositions.h"
#include "analysis/statistics/analysis_of_variance.h"

namespace strainwave::analysis::statistics {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kTailOfInterval = 0.025;  // on either side of a 95 % interval

// What follows from one τ².
struct WeightedMean {
  VectorXd mean;
  MatrixXd covariance;
  double q{};
};

MatrixXd InverseOf(const MatrixXd& covariance) {
  return SymmetricFactor(covariance)
      .Solve(MatrixXd(MatrixXd::Identity(covariance.rows(), covariance.cols())));
}

WeightedMean WeightedMeanAt(std::span<const GroupEstimate> groups, double tau_square) {
  const Eigen::Index d = groups.front().value.size();
  std::vector<MatrixXd> weights;
  MatrixXd sum = MatrixXd::Zero(d, d);
  VectorXd weighted = VectorXd::Zero(d);
  for (const GroupEstimate& group : groups) {
    weights.push_back(InverseOf(group.covariance + tau_square * MatrixXd::Identity(d, d)));
    sum += weights.back();
    weighted += weights.back() * group.value;
  }
  WeightedMean result;
  result.covariance = InverseOf(sum);
  result.mean = result.covariance * weighted;
  for (std::size_t i = 0; i < groups.size(); ++i) {
    const VectorXd off = groups[i].value - result.mean;
    result.q += off.dot(weights[i] * off);
  }
  return result;
}

void Demand(std::span<const GroupEstimate> groups) {
  if (groups.size() < 2)
    throw std::invalid_argument(fmt::format("{} groups (expected two or more)", groups.size()));
  const Eigen::Index d = groups.front().value.size();
  for (const GroupEstimate& group : groups) {
    if (d < 1 || group.value.size() != d || group.covariance.rows() != d || group.covariance.cols() != d)
      throw std::invalid_argument("estimates of groups differ in their number of components");
    if (!group.value.allFinite() || !group.covariance.allFinite())
      throw std::invalid_argument("an estimate of a group is not finite");
    if (!(SymmetricEigenvalues(group.covariance).minCoeff() > 0.0))
      throw std::invalid_argument("the covariance of a group is not positive definite");
  }
}

// τ² at which Q comes down to `level`.
double TauSquareAt(std::span<const GroupEstimate> groups, double level, double scale) {
  const auto above = [&](double tau_square) { return WeightedMeanAt(groups, tau_square).q - level; };
  if (!(above(0.0) > 0.0)) return 0.0;
  double high = scale;
  while (above(high) > 0.0) high *= 4.0;
  std::uintmax_t iterations = 200;
  const auto [low, up] = boost::math::tools::toms748_solve(
      above, 0.0, high, boost::math::tools::eps_tolerance<double>(40), iterations);
  return 0.5 * (low + up);
}

// Where Q at τ = 0 is what is expected of it: linear in τ².
double TauSquareOfMoments(std::span<const GroupEstimate> groups, double q, double degrees_of_freedom) {
  const Eigen::Index d = groups.front().value.size();
  MatrixXd sum = MatrixXd::Zero(d, d);
  MatrixXd squares = MatrixXd::Zero(d, d);
  for (const GroupEstimate& group : groups) {
    const MatrixXd weight = InverseOf(group.covariance);
    sum += weight;
    squares += weight * weight;
  }
  const double slope = sum.trace() - (InverseOf(sum) * squares).trace();
  return std::max(0.0, (q - degrees_of_freedom) / slope);
}

}  // namespace

double ChanceOfChiSquare(double chi_square, double degrees_of_freedom) {
  const boost::math::chi_squared distribution(degrees_of_freedom);
  return boost::math::cdf(boost::math::complement(distribution, std::max(0.0, chi_square)));
}

RandomEffects FitRandomEffects(std::span<const GroupEstimate> groups) {
  Demand(groups);
  const Eigen::Index d = groups.front().value.size();
  const double degrees = static_cast<double>(d) * static_cast<double>(groups.size() - 1);
  RandomEffects result;
  result.degrees_of_freedom = static_cast<int>(degrees);
  result.q = WeightedMeanAt(groups, 0.0).q;
  result.homogeneity_p = ChanceOfChiSquare(result.q, degrees);
  double scale = 0.0;
  for (const GroupEstimate& group : groups)
    scale = std::max(scale, group.covariance.trace() / static_cast<double>(d));
  const boost::math::chi_squared distribution(degrees);
  const auto tau_at = [&](double level) { return std::sqrt(TauSquareAt(groups, level, scale)); };
  result.tau = tau_at(degrees);
  result.tau_low = tau_at(boost::math::quantile(boost::math::complement(distribution, kTailOfInterval)));
  result.tau_high = tau_at(boost::math::quantile(distribution, kTailOfInterval));
  result.tau_of_moments = std::sqrt(TauSquareOfMoments(groups, result.q, degrees));
  WeightedMean at = WeightedMeanAt(groups, result.tau * result.tau);
  const double f = at.mean.dot(InverseOf(at.covariance) * at.mean) / static_cast<double>(d);
  result.mean_p = ChanceOfF(f, static_cast<double>(d), degrees);
  result.mean = std::move(at.mean);
  result.mean_covariance = std::move(at.covariance);
  return result;
}

ExpectedInterval ExpectedTauInterval(double tau, double standard_error, int groups, int components) {
  const double degrees = static_cast<double>(components) * (groups - 1);
  const boost::math::chi_squared distribution(degrees);
  const double error = standard_error * standard_error;
  const auto end = [&](double quantile) {
    return std::sqrt(std::max(0.0, (tau * tau + error) * degrees / quantile - error));
  };
  return {end(boost::math::quantile(boost::math::complement(distribution, kTailOfInterval))),
          end(boost::math::quantile(distribution, kTailOfInterval))};
}

}  // namespace strainwave::analysis::statistics
