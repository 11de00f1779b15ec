// SPDX-License-Identifier: Apache-2.0
#include "analysis/decompositions.h"

#include <gtest/gtest.h>

#include <cmath>

namespace strainwave::analysis::decompositions_test {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

// The third column is the sum of the others.
MatrixXd DependentColumns() {
  MatrixXd columns(4, 3);
  columns << 1, 2, 3, 0, 1, 1, 2, 0, 2, 1, 1, 2;
  return columns;
}

TEST(Decompositions, OfAllSolutionsTheShortest) {
  const VectorXd coefficients = VectorXd{{1.0, 1.0, 0.0}};
  const VectorXd y = DependentColumns() * coefficients;
  // (1, 1, 0) + s (1, 1, −1) is shortest at s = −2/3.
  const VectorXd expected = VectorXd{{1.0 / 3.0, 1.0 / 3.0, 2.0 / 3.0}};
  EXPECT_LT((ShortestLeastSquares(DependentColumns(), y) - expected).norm(), 1e-12);
}

TEST(Decompositions, LeastSquaresLeavesWhatIsAcross) {
  MatrixXd design(3, 1);
  design << 1, 1, 1;
  EXPECT_NEAR(LeastSquares(design, VectorXd{{1.0, 2.0, 6.0}})(0), 3.0, 1e-14);
}

TEST(Decompositions, BasisHasNoColumnForADependentOne) {
  const MatrixXd basis = OrthonormalBasis(DependentColumns());
  ASSERT_EQ(basis.cols(), 2);
  EXPECT_LT((basis.transpose() * basis - MatrixXd::Identity(2, 2)).norm(), 1e-14);
  EXPECT_LT((DependentColumns() - basis * (basis.transpose() * DependentColumns())).norm(), 1e-13);
}

TEST(Decompositions, EigenvaluesRise) {
  MatrixXd symmetric(2, 2);
  symmetric << 2, 1, 1, 2;
  const SymmetricParts parts = SymmetricEigen(symmetric);
  EXPECT_LT((parts.values - VectorXd{{1.0, 3.0}}).norm(), 1e-14);
  EXPECT_LT((SymmetricEigenvalues(symmetric) - parts.values).norm(), 1e-14);
  EXPECT_LT((symmetric * parts.vectors - parts.vectors * parts.values.asDiagonal()).norm(), 1e-14);
}

// What belongs to x = (1, 2) and to the columns of the identity.
TEST(Decompositions, SolversFindWhatWasMultiplied) {
  MatrixXd symmetric(2, 2);
  symmetric << 4, 1, 1, 3;
  const VectorXd x{{1.0, 2.0}};
  const SymmetricFactor factor(symmetric);
  ASSERT_TRUE(factor.succeeded());
  EXPECT_NEAR(factor.pivots().prod(), 11.0, 1e-13);  // the determinant
  EXPECT_LT((factor.Solve(VectorXd(symmetric * x)) - x).norm(), 1e-14);
  EXPECT_LT((factor.Solve(symmetric) - MatrixXd::Identity(2, 2)).norm(), 1e-14);
  EXPECT_LT((SolveSquare(symmetric, symmetric * x) - x).norm(), 1e-14);
  const MatrixXd inverse = InverseCholesky(symmetric);
  EXPECT_LT((inverse.transpose() * inverse * symmetric - MatrixXd::Identity(2, 2)).norm(), 1e-14);
}

TEST(Decompositions, SingularValuesFall) {
  MatrixXd square(2, 2);
  square << 1, 0, 0, -3;
  const SingularParts parts = SquareSingular(square);
  EXPECT_LT((parts.values - VectorXd{{3.0, 1.0}}).norm(), 1e-14);
  EXPECT_NEAR(std::abs(parts.vectors(1, 0)), 1.0, 1e-14);
}

}  // namespace
}  // namespace strainwave::analysis::decompositions_test
