// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>

namespace strainwave::analysis::diagnosis {

/// aᵀ b and aᵀ a of matrices with many rows and a few dozen columns.
Eigen::MatrixXd ProductsOfColumns(const Eigen::Ref<const Eigen::MatrixXd>& a,
                                  const Eigen::Ref<const Eigen::MatrixXd>& b);
Eigen::MatrixXd SquaresOfColumns(const Eigen::Ref<const Eigen::MatrixXd>& a);

/// Least squares of one channel on its own columns.
struct ChannelFit {
  Eigen::VectorXd coefficients;
  Eigen::MatrixXd inverse;   // of the weighted normal matrix, pseudo-inverse where columns coincide
  Eigen::VectorXd residual;  // all samples
  double square_sum{};       // weighted
};

/// Gauss–Newton step for numbers that all channels share, the channels' own coefficients projected out.
struct SharedStep {
  Eigen::MatrixXd normal;
  Eigen::VectorXd gradient;

  explicit SharedStep(Eigen::Index numbers)
      : normal(Eigen::MatrixXd::Zero(numbers, numbers)), gradient(Eigen::VectorXd::Zero(numbers)) {}

  /// A channel without weights.
  /// @param derivatives  of its model by the shared numbers.
  void Add(const Eigen::Ref<const Eigen::MatrixXd>& columns, const Eigen::MatrixXd& derivatives,
           const ChannelFit& fit);
};

/// Pseudo-inverse of a symmetric, positive semidefinite matrix.
Eigen::MatrixXd PseudoInverse(const Eigen::MatrixXd& symmetric);

}  // namespace strainwave::analysis::diagnosis
