// SPDX-License-Identifier: Apache-2.0
#include "analysis/linear_regression.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <stdexcept>
#include <vector>

#include "analysis/autocorrelation.h"
#include "analysis/decompositions.h"

namespace strainwave::analysis {
namespace {

// (AᵀA)⁻¹ with unit columns in between, so that columns of very different size do not lose digits; zero rows
// and columns where the factorisation found a column to be made up of the others.
Eigen::MatrixXd NormalInverse(const Eigen::MatrixXd& a, Eigen::Index* rank) {
  const Eigen::Index p = a.cols();
  Eigen::VectorXd scale = a.colwise().norm();
  for (double& s : scale) {
    s = s > 0.0 ? 1.0 / s : 0.0;
  }
  const Eigen::MatrixXd normal = scale.asDiagonal() * (a.transpose() * a).eval() * scale.asDiagonal();
  const SymmetricParts eigen = SymmetricEigen(normal);
  const double floor = 1e-13 * std::max(eigen.values.maxCoeff(), 0.0);
  *rank = (eigen.values.array() > floor).count();
  Eigen::MatrixXd result = eigen.vectors * eigen.InverseAbove(floor).asDiagonal() * eigen.vectors.transpose();
  result = scale.asDiagonal() * result * scale.asDiagonal();
  return result.topLeftCorner(p, p);
}

}  // namespace

double LinearFit::StandardError(Eigen::Index column) const {
  return std::sqrt(std::max(0.0, covariance(column, column)));
}

LinearFit FitLinear(const Eigen::MatrixXd& design, const Eigen::VectorXd& y, ErrorModel errors) {
  const Eigen::Index n = design.rows();
  const Eigen::Index p = design.cols();
  if (n != y.size()) {
    throw std::invalid_argument(
        fmt::format("y has {} values, design has {} rows (expected the same number)", y.size(), n));
  }
  if (n < p) {
    throw std::invalid_argument(
        fmt::format("design has {} rows (expected at least as many as its {} columns)", n, p));
  }
  Eigen::VectorXd scale = design.colwise().norm();
  for (double& s : scale) {
    s = s > 0.0 ? 1.0 / s : 1.0;
  }
  const Eigen::MatrixXd scaled = design * scale.asDiagonal();
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(scaled.rows(), scaled.cols());
  qr.setThreshold(1e-10);
  qr.compute(scaled);

  LinearFit fit;
  fit.rank = qr.rank();
  fit.coefficients = scale.asDiagonal() * qr.solve(y).eval();
  fit.residuals = y - design * fit.coefficients;
  const double freedom = static_cast<double>(n - fit.rank);
  fit.residual_standard_deviation = freedom > 0.0 ? std::sqrt(fit.residuals.squaredNorm() / freedom) : 0.0;

  // Only the columns that carry something enter the covariance.
  std::vector<Eigen::Index> kept(qr.colsPermutation().indices().data(),
                                 qr.colsPermutation().indices().data() + fit.rank);
  std::sort(kept.begin(), kept.end());
  const Eigen::MatrixXd active = design(Eigen::all, kept);
  Eigen::MatrixXd covariance;
  if (errors == ErrorModel::kIndependent) {
    Eigen::Index rank = 0;
    const double variance = fit.residual_standard_deviation * fit.residual_standard_deviation;
    covariance = NormalInverse(active, &rank) * variance;
  } else {
    covariance = SandwichCovariance(active, fit.residuals);
  }
  fit.covariance = Eigen::MatrixXd::Zero(p, p);
  fit.covariance(kept, kept) = covariance;
  return fit;
}

Eigen::MatrixXd SandwichCovariance(const Eigen::MatrixXd& jacobian, const Eigen::VectorXd& residuals) {
  Eigen::Index rank = 0;
  const Eigen::MatrixXd bread = NormalInverse(jacobian, &rank);
  const Eigen::MatrixXd scores = residuals.asDiagonal() * jacobian;
  const std::span<const double> samples(residuals.data(), static_cast<std::size_t>(residuals.size()));
  const Eigen::MatrixXd meat = ScoreCovariance(scores, samples);
  const auto n = static_cast<double>(jacobian.rows());
  const double freedom = std::max(1.0, n - static_cast<double>(rank));
  return bread * meat * bread * (n / freedom);
}

}  // namespace strainwave::analysis
