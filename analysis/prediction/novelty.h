// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace strainwave::analysis::prediction {

/// Tells how far a record lies from those that were trained on.
struct Novelty {
  Eigen::RowVectorXd mean;
  Eigen::MatrixXd whitening;  // inputs × inputs: (x − mean) · whitening has unit covariance
  double limit{};             // of the distance; beyond it a record is outside what was trained on

  /// Mahalanobis distance over the square root of the number of inputs, one a row: about 1 for a record like
  /// those trained on.
  Eigen::VectorXd Distance(const Eigen::MatrixXd& features) const;
};

/// The distance that this share of records keeps to; of as many values as there are, rounded up.
double DistanceKept(const Eigen::VectorXd& distance, double share);

/// Fits mean and covariance, the covariance shrunk towards a multiple of the unit matrix as far as its own
/// noise asks for, and sets the limit a tenth above the quantile that the records `apart`, which the fit does
/// not see, keep to.
///
/// @param features, apart  rows of scaled inputs.
/// @param inside  share of `apart` that lies within, for instance 0.99.
/// @throws std::invalid_argument if there are fewer than 3 rows, none apart, or other columns.
///
/// Source: Ledoit & Wolf (2004), A well-conditioned estimator for large-dimensional covariance matrices;
/// Mahalanobis (1936).
Novelty FitNovelty(const Eigen::MatrixXd& features, const Eigen::MatrixXd& apart, double inside);

}  // namespace strainwave::analysis::prediction
