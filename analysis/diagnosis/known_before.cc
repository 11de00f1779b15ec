// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/known_before.h"

#include <algorithm>
#include <cmath>

#include "analysis/decompositions.h"
#include "analysis/units.h"

namespace strainwave::analysis::diagnosis {

double KnownBefore(const Eigen::MatrixXd& by_known, Eigen::MatrixXd by_others, std::span<const double> ranges,
                   double variance, double samples) {
  if (by_known.cols() == 0) return 0.0;
  for (Eigen::Index j = 0; j < by_others.cols(); ++j) {
    const double norm = by_others.col(j).norm();
    if (norm > 0.0) by_others.col(j) /= norm;
  }
  const Eigen::MatrixXd common = by_others.transpose() * by_known;
  const Eigen::MatrixXd gram = by_others.transpose() * by_others;
  const Eigen::MatrixXd information =
      (by_known.transpose() * by_known - common.transpose() * ShortestLeastSquares(gram, common)) /
      std::max(variance, 1e-300);
  const Eigen::Map<const Eigen::VectorXd> range(ranges.data(), static_cast<Eigen::Index>(ranges.size()));
  const Eigen::MatrixXd excluded = range.asDiagonal() * information * range.asDiagonal() / kTwoPi;
  double free = 0.0;
  for (const double value : SymmetricEigenvalues(excluded)) {
    free += 1.0 - std::min(1.0, std::log1p(std::max(value, 0.0)) / std::log(std::max(samples, 3.0)));
  }
  return free;
}

}  // namespace strainwave::analysis::diagnosis
