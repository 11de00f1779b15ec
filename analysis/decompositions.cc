// SPDX-License-Identifier: Apache-2.0
#include "analysis/decompositions.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/QR>
#include <Eigen/SVD>

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

SymmetricFactor::SymmetricFactor(const MatrixXd& symmetric) : factor_(symmetric) {}

bool SymmetricFactor::succeeded() const { return factor_.info() == Eigen::Success; }

VectorXd SymmetricFactor::pivots() const { return factor_.vectorD(); }

VectorXd SymmetricFactor::Solve(const VectorXd& b) const { return factor_.solve(b); }

MatrixXd SymmetricFactor::Solve(const MatrixXd& b) const { return factor_.solve(b); }

MatrixXd InverseCholesky(const MatrixXd& symmetric) {
  const MatrixXd identity = MatrixXd::Identity(symmetric.rows(), symmetric.cols());
  return Eigen::LLT<MatrixXd>(symmetric).matrixL().solve(identity);
}

MatrixXd SolveSquare(const MatrixXd& square, const MatrixXd& b) { return square.partialPivLu().solve(b); }

SingularParts SquareSingular(const MatrixXd& square) {
  // QR comes before only where there are more rows than columns, or fewer.
  const Eigen::JacobiSVD<MatrixXd, Eigen::NoQRPreconditioner> parts(square, Eigen::ComputeFullU);
  return {.values = parts.singularValues(), .vectors = parts.matrixU()};
}

}  // namespace strainwave::analysis
