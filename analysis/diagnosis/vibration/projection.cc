// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/vibration/projection.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "analysis/decompositions.h"
#include "analysis/products.h"

namespace strainwave::analysis::diagnosis {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

// Rows of two dozen columns that the second cache holds.
constexpr Index kRowsTogether = 2048;

}  // namespace

MatrixXd ProductsOfColumns(const Eigen::Ref<const MatrixXd>& a, const Eigen::Ref<const MatrixXd>& b) {
  MatrixXd products = MatrixXd::Zero(a.cols(), b.cols());
  for (Index first = 0; first < a.rows(); first += kRowsTogether) {
    MultiplyRows<double>({a.data() + first, a.outerStride()}, {b.data() + first, b.outerStride()},
                         {products.data(), 1, products.outerStride()}, a.cols(), b.cols(),
                         std::min(kRowsTogether, a.rows() - first), Sum::kAdd);
  }
  return products;
}

MatrixXd SquaresOfColumns(const Eigen::Ref<const MatrixXd>& a) {
  constexpr Index kTogether = 6;  // columns; right of the diagonal is computed for them alone
  MatrixXd products(a.cols(), a.cols());
  for (Index first = 0; first < a.cols(); first += kTogether) {
    const Index width = std::min(kTogether, a.cols() - first);
    products.middleRows(first, width).leftCols(first + width) =
        ProductsOfColumns(a.middleCols(first, width), a.leftCols(first + width));
  }
  return products.selfadjointView<Eigen::Lower>();
}

MatrixXd PseudoInverse(const MatrixXd& symmetric) {
  if (symmetric.rows() == 0) return symmetric;
  // To unit diagonal first: columns differ in size by their units.
  VectorXd scale = symmetric.diagonal();
  for (Index i = 0; i < scale.size(); ++i) scale(i) = scale(i) > 0.0 ? 1.0 / std::sqrt(scale(i)) : 0.0;
  const SymmetricParts unit = SymmetricEigen(scale.asDiagonal() * symmetric * scale.asDiagonal());
  constexpr double kSmallest = 1e-10;
  return scale.asDiagonal() *
         (unit.vectors * unit.InverseAbove(kSmallest).asDiagonal() * unit.vectors.transpose()) *
         scale.asDiagonal();
}

void SharedStep::Add(const Eigen::Ref<const MatrixXd>& columns, const MatrixXd& derivatives,
                     const ChannelFit& fit) {
  const MatrixXd common = ProductsOfColumns(columns, derivatives);
  normal += SquaresOfColumns(derivatives) - common.transpose() * fit.inverse * common;
  gradient += ProductsOfColumns(derivatives, fit.residual);
}

}  // namespace strainwave::analysis::diagnosis
