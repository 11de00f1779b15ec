// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace strainwave::analysis::prediction {

/// Columns to (x − offset) / scale and back.
struct Scaler {
  Eigen::RowVectorXd offset;
  Eigen::RowVectorXd scale;

  Eigen::MatrixXd Apply(const Eigen::MatrixXd& values) const;
  Eigen::MatrixXd Undo(const Eigen::MatrixXd& scaled) const;
};

/// Mean 0 and standard deviation 1. A column that does not vary keeps a scale of one.
/// @throws std::invalid_argument if there is no row.
Scaler Standardizing(const Eigen::MatrixXd& values);

/// Leaves this many columns as they are.
Scaler Unscaled(Eigen::Index columns);

/// Divides by the mean magnitude and shifts nothing, so that a percentage error stays what it is.
/// @throws std::invalid_argument if there is no row.
Scaler Dividing(const Eigen::MatrixXd& values);

}  // namespace strainwave::analysis::prediction
