// SPDX-License-Identifier: Apache-2.0
#include "analysis/prediction/correlation_filter.h"

#include <fmt/format.h>

#include <cmath>
#include <stdexcept>

#include "analysis/prediction/scaler.h"

namespace strainwave::analysis::prediction {

std::vector<FilteredColumn> FilterCorrelated(const Eigen::MatrixXd& values, double limit) {
  if (values.rows() < 3) {
    throw std::invalid_argument(fmt::format("values has {} rows (expected at least 3)", values.rows()));
  }
  if (!(limit > 0.0 && limit <= 1.0)) {
    throw std::invalid_argument(fmt::format("limit = {} is not between 0 and 1", limit));
  }
  const Scaler scaler = Standardizing(values);
  // Unit columns: a correlation is a scalar product.
  Eigen::MatrixXd unit = scaler.Apply(values) / std::sqrt(static_cast<double>(values.rows()));

  std::vector<FilteredColumn> columns(static_cast<std::size_t>(values.cols()));
  Eigen::MatrixXd kept(values.rows(), values.cols());
  std::vector<Eigen::Index> kept_index;
  for (Eigen::Index column = 0; column < values.cols(); ++column) {
    FilteredColumn& verdict = columns[static_cast<std::size_t>(column)];
    const double norm = unit.col(column).norm();
    if (!(norm > 0.5)) continue;  // constant (zero) or not finite
    const auto count = static_cast<Eigen::Index>(kept_index.size());
    Eigen::Index nearest = 0;
    double magnitude = 0.0;
    Eigen::VectorXd correlation;
    if (count > 0) {
      correlation = kept.leftCols(count).transpose() * unit.col(column);
      magnitude = correlation.cwiseAbs().maxCoeff(&nearest);
    }
    if (magnitude > limit) {
      verdict.like = kept_index[static_cast<std::size_t>(nearest)];
      verdict.correlation = correlation(nearest);
      continue;
    }
    verdict.kept = true;
    kept.col(count) = unit.col(column);
    kept_index.push_back(column);
  }
  return columns;
}

std::vector<Eigen::Index> KeptColumns(const std::vector<FilteredColumn>& columns) {
  std::vector<Eigen::Index> kept;
  for (std::size_t i = 0; i < columns.size(); ++i) {
    if (columns[i].kept) kept.push_back(static_cast<Eigen::Index>(i));
  }
  return kept;
}

}  // namespace strainwave::analysis::prediction
