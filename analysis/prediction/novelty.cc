// SPDX-License-Identifier: Apache-2.0
#include "analysis/prediction/novelty.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <vector>

#include "analysis/decompositions.h"

namespace strainwave::analysis::prediction {
namespace {

constexpr double kMargin = 1.1;

// Share of the covariance that is replaced by a multiple of the unit matrix: its expected squared sampling
// error over its squared distance from that target.
double Shrinkage(const Eigen::MatrixXd& centred, const Eigen::MatrixXd& covariance, double mean_variance) {
  const auto n = static_cast<double>(centred.rows());
  const auto p = static_cast<double>(centred.cols());
  Eigen::MatrixXd apart = covariance;
  apart.diagonal().array() -= mean_variance;
  const double distance = apart.squaredNorm() / p;
  // Σᵢ ‖xᵢxᵢᵀ − S‖² = Σᵢ ‖xᵢ‖⁴ − n‖S‖².
  const double scatter =
      (centred.rowwise().squaredNorm().array().square().sum() - n * covariance.squaredNorm()) / (n * n * p);
  return distance > 0.0 ? std::clamp(scatter / distance, 0.0, 1.0) : 1.0;
}

}  // namespace

Eigen::VectorXd Novelty::Distance(const Eigen::MatrixXd& features) const {
  const double inputs = static_cast<double>(std::max<Eigen::Index>(mean.size(), 1));
  return ((features.rowwise() - mean) * whitening).rowwise().norm() / std::sqrt(inputs);
}

double DistanceKept(const Eigen::VectorXd& distance, double share) {
  std::vector<double> sorted(distance.begin(), distance.end());
  std::sort(sorted.begin(), sorted.end());
  const double at = std::ceil(share * static_cast<double>(sorted.size() - 1));
  return sorted[static_cast<std::size_t>(at)];
}

Novelty FitNovelty(const Eigen::MatrixXd& features, const Eigen::MatrixXd& apart, double inside) {
  if (features.rows() < 3 || apart.rows() < 1 || apart.cols() != features.cols()) {
    throw std::invalid_argument(fmt::format(
        "features is {} × {}, apart {} × {} (expected at least 3 rows and 1 row, and the same columns)",
        features.rows(), features.cols(), apart.rows(), apart.cols()));
  }
  Novelty novelty;
  novelty.mean = features.colwise().mean();
  const Eigen::MatrixXd centred = features.rowwise() - novelty.mean;
  Eigen::MatrixXd covariance = centred.transpose() * centred / static_cast<double>(features.rows());
  const double mean_variance = covariance.trace() / static_cast<double>(features.cols());
  // Never none: with as many inputs as rows the smallest variances are zero by construction.
  const double share = std::max(Shrinkage(centred, covariance, mean_variance), 1e-4);
  covariance *= 1.0 - share;
  covariance.diagonal().array() += std::max(share * mean_variance, 1e-300);
  // xᵀ(LLᵀ)⁻¹x = ‖L⁻¹x‖²: rows are multiplied by L⁻ᵀ.
  novelty.whitening = InverseCholesky(covariance).transpose();

  novelty.limit = kMargin * DistanceKept(novelty.Distance(apart), inside);
  return novelty;
}

}  // namespace strainwave::analysis::prediction
