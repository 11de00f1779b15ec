// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Cholesky>

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

/// The x ≥ 0 that makes ‖a x − b‖ least, by active sets.
///
/// Source: docs/sources.md#lawson-1974, chapter 23.
Eigen::VectorXd NonNegativeLeastSquares(const ConstMatrixRef& a, const ConstVectorRef& b);

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

/// P symmetric Pᵀ = L D Lᵀ with pivoting, of a positive or negative semidefinite matrix.
class SymmetricFactor {
 public:
  explicit SymmetricFactor(const Eigen::MatrixXd& symmetric);

  /// Whether the matrix is semidefinite as far as its numbers tell.
  bool succeeded() const;
  /// The diagonal of D.
  Eigen::VectorXd pivots() const;
  /// The x with symmetric · x = b. One x per column of b.
  Eigen::VectorXd Solve(const Eigen::VectorXd& b) const;
  Eigen::MatrixXd Solve(const Eigen::MatrixXd& b) const;

 private:
  Eigen::LDLT<Eigen::MatrixXd> factor_;
};

/// The inverse of L in LLᵀ, of a positive definite matrix.
Eigen::MatrixXd InverseCholesky(const Eigen::MatrixXd& symmetric);

/// The x with square · x = b, by LU with partial pivoting. One x per column of b.
Eigen::MatrixXd SolveSquare(const Eigen::MatrixXd& square, const Eigen::MatrixXd& b);

/// A square matrix as vectors · diag(values) · Wᵀ, W orthogonal, values falling, by Jacobi's rotations.
struct SingularParts {
  Eigen::VectorXd values;
  Eigen::MatrixXd vectors;  // orthonormal columns
};
SingularParts SquareSingular(const Eigen::MatrixXd& square);

}  // namespace strainwave::analysis
