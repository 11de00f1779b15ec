// SPDX-License-Identifier: Apache-2.0
#include "analysis/decompositions.h"

#include <Eigen/Eigenvalues>
#include <Eigen/QR>

namespace strainwave::analysis {

using Eigen::MatrixXd;
using Eigen::VectorXd;

VectorXd LeastSquares(const ConstMatrixRef& a, const ConstVectorRef& b) {
  return Eigen::ColPivHouseholderQR<MatrixXd>(a).solve(b);
}

MatrixXd ShortestLeastSquares(const ConstMatrixRef& a, const ConstMatrixRef& b) {
  return Eigen::CompleteOrthogonalDecomposition<MatrixXd>(a).solve(b);
}

SymmetricParts SymmetricEigen(const MatrixXd& symmetric) {
  const Eigen::SelfAdjointEigenSolver<MatrixXd> solver(symmetric);
  return {.values = solver.eigenvalues(), .vectors = solver.eigenvectors()};
}

VectorXd SymmetricParts::InverseAbove(double floor) const {
  return values.unaryExpr([floor](double value) { return value > floor ? 1.0 / value : 0.0; });
}

VectorXd SymmetricEigenvalues(const MatrixXd& symmetric) {
  return Eigen::SelfAdjointEigenSolver<MatrixXd>(symmetric, Eigen::EigenvaluesOnly).eigenvalues();
}

MatrixXd OrthonormalBasis(const MatrixXd& columns) {
  const Eigen::ColPivHouseholderQR<MatrixXd> factor(columns);
  return factor.householderQ() * MatrixXd::Identity(columns.rows(), factor.rank());
}

}  // namespace strainwave::analysis
