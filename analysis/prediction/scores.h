// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include <vector>

namespace strainwave::analysis::prediction {

/// How well one output is predicted. Source: docs/sources.md#shivam-2023, eq. 5 to 7.
struct OutputScore {
  double nmse{};              // Σ (y − ŷ)² / Σ y²
  double mape_percent{};      // 100 · mean |y − ŷ| / |y|: the printed equation 6 lacks the division by y
  double accuracy_percent{};  // 100 − MAPE
  double rmse{};              // in the output's unit
};

/// One score a column.
/// @param actual, predicted  n × outputs.
/// @throws std::invalid_argument if the shapes differ, there is no row, or an actual value is zero (a share
///   of it is none).
std::vector<OutputScore> ScoresOf(const Eigen::MatrixXd& actual, const Eigen::MatrixXd& predicted);

/// The mean over all outputs.
double MeanMape_percent(const std::vector<OutputScore>& scores) noexcept;

/// How often records of one class (row) were given to another (column): of each row of predictions the
/// greatest counts.
/// @param actual, predicted  n × classes; `actual` is 1 in one place of each row.
/// @throws std::invalid_argument if the shapes differ or there is no row.
Eigen::MatrixXi Confusion(const Eigen::MatrixXd& actual, const Eigen::MatrixXd& predicted);

/// Share of the records that were given their own class.
double Accuracy_percent(const Eigen::MatrixXi& confusion) noexcept;

}  // namespace strainwave::analysis::prediction
