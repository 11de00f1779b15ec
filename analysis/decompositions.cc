// SPDX-License-Identifier: Apache-2.0
#include "analysis/decompositions.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/QR>
#include <Eigen/SVD>
#include <algorithm>
#include <utility>
#include <vector>

namespace strainwave::analysis {

using Eigen::MatrixXd;
using Eigen::VectorXd;

VectorXd LeastSquares(const ConstMatrixRef& a, const ConstVectorRef& b) {
  return Eigen::ColPivHouseholderQR<MatrixXd>(a).solve(b);
}

MatrixXd ShortestLeastSquares(const ConstMatrixRef& a, const ConstMatrixRef& b) {
  return Eigen::CompleteOrthogonalDecomposition<MatrixXd>(a).solve(b);
}

VectorXd NonNegativeLeastSquares(const ConstMatrixRef& a, const ConstVectorRef& b) {
  const Eigen::Index n = a.cols();
  VectorXd x = VectorXd::Zero(n);
  std::vector<Eigen::Index> free;
  const double tolerance = 1e-11 * std::max(1.0, (a.transpose() * b).cwiseAbs().maxCoeff());
  for (Eigen::Index round = 0; round < 3 * n + 10; ++round) {
    VectorXd gradient = a.transpose() * (b - a * x);
    for (const Eigen::Index i : free) gradient(i) = 0.0;
    Eigen::Index next = 0;
    if (!(gradient.maxCoeff(&next) > tolerance)) break;
    free.push_back(next);
    while (!free.empty()) {
      const MatrixXd columns = a(Eigen::all, free);
      const VectorXd wanted = ShortestLeastSquares(columns, b);
      if (wanted.minCoeff() > 0.0) {
        x.setZero();
        for (std::size_t i = 0; i < free.size(); ++i) x(free[i]) = wanted(static_cast<Eigen::Index>(i));
        break;
      }
      double step = 1.0;
      for (std::size_t i = 0; i < free.size(); ++i) {
        const double to = wanted(static_cast<Eigen::Index>(i));
        if (to <= 0.0) step = std::min(step, x(free[i]) / (x(free[i]) - to + 1e-300));
      }
      std::vector<Eigen::Index> kept;
      for (std::size_t i = 0; i < free.size(); ++i) {
        double& value = x(free[i]);
        value += step * (wanted(static_cast<Eigen::Index>(i)) - value);
        if (value > 1e-14) {
          kept.push_back(free[i]);
        } else {
          value = 0.0;
        }
      }
      free = std::move(kept);
    }
  }
  return x;
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
