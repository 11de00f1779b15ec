// SPDX-License-Identifier: Apache-2.0
#include "analysis/prediction/scores.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace strainwave::analysis::prediction {

namespace {

void RequireSameShape(const Eigen::MatrixXd& actual, const Eigen::MatrixXd& predicted) {
  if (actual.rows() != predicted.rows() || actual.cols() != predicted.cols() || actual.rows() == 0) {
    throw std::invalid_argument(
        fmt::format("predicted is {} × {}, actual {} × {} (expected the same, from one row)",
                    predicted.rows(), predicted.cols(), actual.rows(), actual.cols()));
  }
}

}  // namespace

std::vector<OutputScore> ScoresOf(const Eigen::MatrixXd& actual, const Eigen::MatrixXd& predicted) {
  RequireSameShape(actual, predicted);
  std::vector<OutputScore> scores;
  for (Eigen::Index column = 0; column < actual.cols(); ++column) {
    const auto y = actual.col(column).array();
    const auto error = y - predicted.col(column).array();
    if ((y == 0.0).any()) {
      throw std::invalid_argument(
          fmt::format("actual has a zero in column {} (expected none: an error is a share of it)", column));
    }
    const double mape_percent = 100.0 * (error / y).abs().mean();
    scores.push_back({.nmse = error.square().sum() / y.square().sum(),
                      .mape_percent = mape_percent,
                      .accuracy_percent = 100.0 - mape_percent,
                      .rmse = std::sqrt(error.square().mean())});
  }
  return scores;
}

double MeanMape_percent(const std::vector<OutputScore>& scores) noexcept {
  double sum_percent = 0.0;
  for (const OutputScore& score : scores) sum_percent += score.mape_percent;
  return scores.empty() ? 0.0 : sum_percent / static_cast<double>(scores.size());
}

Eigen::MatrixXi Confusion(const Eigen::MatrixXd& actual, const Eigen::MatrixXd& predicted) {
  RequireSameShape(actual, predicted);
  Eigen::MatrixXi counts = Eigen::MatrixXi::Zero(actual.cols(), actual.cols());
  for (Eigen::Index row = 0; row < actual.rows(); ++row) {
    Eigen::Index own = 0;
    Eigen::Index given = 0;
    actual.row(row).maxCoeff(&own);
    predicted.row(row).maxCoeff(&given);
    ++counts(own, given);
  }
  return counts;
}

double Accuracy_percent(const Eigen::MatrixXi& confusion) noexcept {
  return 100.0 * confusion.trace() / std::max(1, confusion.sum());
}

}  // namespace strainwave::analysis::prediction
