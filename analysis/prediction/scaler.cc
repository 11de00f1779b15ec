// SPDX-License-Identifier: Apache-2.0
#include "analysis/prediction/scaler.h"

#include <limits>
#include <stdexcept>

namespace strainwave::analysis::prediction {
namespace {

void RequireRows(const Eigen::MatrixXd& values) {
  if (values.rows() == 0) throw std::invalid_argument("values has no row (expected one or more)");
}

// What rounding alone makes of a constant is no variation.
constexpr double kRounding = 64.0 * std::numeric_limits<double>::epsilon();

}  // namespace

Eigen::MatrixXd Scaler::Apply(const Eigen::MatrixXd& values) const {
  return (values.rowwise() - offset).array().rowwise() / scale.array();
}

Eigen::MatrixXd Scaler::Undo(const Eigen::MatrixXd& scaled) const {
  return (scaled.array().rowwise() * scale.array()).matrix().rowwise() + offset;
}

Scaler Standardizing(const Eigen::MatrixXd& values) {
  RequireRows(values);
  Scaler scaler;
  scaler.offset = values.colwise().mean();
  scaler.scale = (values.rowwise() - scaler.offset).array().square().colwise().mean().sqrt();
  for (Eigen::Index column = 0; column < values.cols(); ++column) {
    if (scaler.scale(column) <= kRounding * std::abs(scaler.offset(column))) scaler.scale(column) = 1.0;
  }
  return scaler;
}

Scaler Unscaled(Eigen::Index columns) {
  return {Eigen::RowVectorXd::Zero(columns), Eigen::RowVectorXd::Ones(columns)};
}

Scaler Dividing(const Eigen::MatrixXd& values) {
  RequireRows(values);
  Scaler scaler;
  scaler.offset = Eigen::RowVectorXd::Zero(values.cols());
  scaler.scale = values.array().abs().colwise().mean();
  for (double& scale : scaler.scale) {
    if (scale == 0.0) scale = 1.0;
  }
  return scaler;
}

}  // namespace strainwave::analysis::prediction
