// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include <span>

namespace strainwave::analysis::prediction {

/// A linear predictor with shrunk coefficients: what a network has to beat.
struct Ridge {
  Eigen::RowVectorXd mean;       // of the inputs
  Eigen::RowVectorXd intercept;  // outputs
  Eigen::MatrixXd slope;         // inputs × outputs
  double penalty{};              // λ, in units of the number of rows

  Eigen::MatrixXd Predict(const Eigen::MatrixXd& features) const;
};

/// Minimises ‖Y − XB‖² + n λ ‖B‖² for the λ, of a grid, whose predictions of groups left out are the best;
/// outputs are weighed by their variance.
///
/// @param features  n × inputs, scaled.
/// @param targets   n × outputs.
/// @param group     n; rows of one group are left out together. All of one group: every fifth of the rows.
/// @throws std::invalid_argument if the row counts differ or there are fewer than 5 rows.
Ridge FitRidge(const Eigen::MatrixXd& features, const Eigen::MatrixXd& targets, std::span<const int> group);

}  // namespace strainwave::analysis::prediction
