// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace strainwave::analysis {

// Eigen's decompositions as plain functions. Each costs the compiler seconds wherever it is used; here each
// is compiled once.

using ConstMatrixRef = Eigen::Ref<const Eigen::MatrixXd>;
using ConstVectorRef = Eigen::Ref<const Eigen::VectorXd>;

/// The x that makes ‖a x − b‖ least, by column-pivoting QR; zero for columns that the others make up.
///
/// @param a  n × p with n ≥ p.
/// @param b  n values.
Eigen::VectorXd LeastSquares(const ConstMatrixRef& a, const ConstVectorRef& b);

/// Of all x that make ‖a x − b‖ least the shortest, by complete orthogonal decomposition: also where columns
/// coincide or are zero. One x per column of b.
Eigen::MatrixXd ShortestLeastSquares(const ConstMatrixRef& a, const ConstMatrixRef& b);

/// A symmetric matrix as vectors · diag(values) · vectorsᵀ, values rising.
struct SymmetricParts {
  Eigen::VectorXd values;
  Eigen::MatrixXd vectors;  // orthonormal columns

  /// Of the pseudo-inverse: 1 / value, and 0 where a value is not above the floor.
  Eigen::VectorXd InverseAbove(double floor) const;
};
SymmetricParts SymmetricEigen(const Eigen::MatrixXd& symmetric);

/// The eigenvalues alone, rising.
Eigen::VectorXd SymmetricEigenvalues(const Eigen::MatrixXd& symmetric);

/// Orthonormal columns that span the same space; fewer where columns are made up of others.
Eigen::MatrixXd OrthonormalBasis(const Eigen::MatrixXd& columns);

}  // namespace strainwave::analysis
