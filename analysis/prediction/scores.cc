// SPDX-License-Identifier: Apache-2.0
#include "analysis/prediction/scores.h"

#include <fmt/format.h>

#include <cmath>
#include <stdexcept>

namespace strainwave::analysis::prediction {

std::vector<OutputScore> ScoresOf(const Eigen::MatrixXd& actual, const Eigen::MatrixXd& predicted) {
  if (actual.rows() != predicted.rows() || actual.cols() != predicted.cols() || actual.rows() == 0) {
    throw std::invalid_argument(
        fmt::format("predicted is {} × {}, actual {} × {} (expected the same, from one row)",
                    predicted.rows(), predicted.cols(), actual.rows(), actual.cols()));
  }
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

}  // namespace strainwave::analysis::prediction
