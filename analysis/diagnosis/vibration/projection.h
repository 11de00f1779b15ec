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
/// Inverse of the columns' weighted normal matrix.
Eigen::MatrixXd NormalInverse(const Eigen::Ref<const Eigen::MatrixXd>& columns,
                              const Eigen::Ref<const Eigen::VectorXd>& weights);
/// @param inverse  NormalInverse; channels with equal columns and weights share it
ChannelFit FitChannel(const Eigen::Ref<const Eigen::MatrixXd>& columns,
                      const Eigen::Ref<const Eigen::VectorXd>& response,
                      const Eigen::Ref<const Eigen::VectorXd>& weights, Eigen::MatrixXd inverse);
ChannelFit FitChannel(const Eigen::Ref<const Eigen::MatrixXd>& columns,
                      const Eigen::Ref<const Eigen::VectorXd>& response,
                      const Eigen::Ref<const Eigen::VectorXd>& weights);

/// Gauss–Newton step for numbers that all channels share, the channels' own coefficients projected out.
struct SharedStep {
  Eigen::MatrixXd normal;
  Eigen::VectorXd gradient;

  explicit SharedStep(Eigen::Index numbers)
      : normal(Eigen::MatrixXd::Zero(numbers, numbers)), gradient(Eigen::VectorXd::Zero(numbers)) {}

  /// @param derivatives  of this channel's model by the shared numbers.
  /// @returns what a change of the shared numbers does to the channel's coefficients (columns × numbers).
  Eigen::MatrixXd Add(const Eigen::Ref<const Eigen::MatrixXd>& columns, const Eigen::MatrixXd& derivatives,
                      const ChannelFit& fit, const Eigen::Ref<const Eigen::VectorXd>& weights);
};

/// Pseudo-inverse of a symmetric, positive semidefinite matrix.
Eigen::MatrixXd PseudoInverse(const Eigen::MatrixXd& symmetric);

}  // namespace strainwave::analysis::diagnosis
