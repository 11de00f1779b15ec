// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/vibration/projection.h"

#include <algorithm>
#include <cmath>

#include "analysis/decompositions.h"
#include "analysis/diagnosis/vibration/column_blocks.h"

namespace strainwave::analysis::diagnosis {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

// Rows of two dozen columns that the second cache holds.
constexpr Index kRowsOfProduct = 2048;

}  // namespace

MatrixXd ProductsOfColumns(const Eigen::Ref<const MatrixXd>& a, const Eigen::Ref<const MatrixXd>& b) {
  MatrixXd products = MatrixXd::Zero(a.cols(), b.cols());
  for (Index first = 0; first < a.rows(); first += kRowsOfProduct)
    AddProducts(BlockOf(a, first), BlockOf(b, first), std::min(kRowsOfProduct, a.rows() - first), products);
  return products;
}

MatrixXd SquaresOfColumns(const Eigen::Ref<const MatrixXd>& a) {
  MatrixXd products = MatrixXd::Zero(a.cols(), a.cols());
  for (Index first = 0; first < a.rows(); first += kRowsOfProduct)
    AddSymmetric(BlockOf(a, first), BlockOf(a, first), std::min(kRowsOfProduct, a.rows() - first), products);
  return WithUpperHalf(products);
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
