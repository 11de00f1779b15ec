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

bool AllOne(const Eigen::Ref<const VectorXd>& weights) { return (weights.array() == 1.0).all(); }

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

MatrixXd NormalInverse(const Eigen::Ref<const MatrixXd>& columns, const Eigen::Ref<const VectorXd>& weights) {
  if (AllOne(weights)) return PseudoInverse(SquaresOfColumns(columns));
  return PseudoInverse(SquaresOfColumns(weights.cwiseSqrt().asDiagonal() * columns));
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

ChannelFit FitChannel(const Eigen::Ref<const MatrixXd>& columns, const Eigen::Ref<const VectorXd>& response,
                      const Eigen::Ref<const VectorXd>& weights, MatrixXd inverse) {
  ChannelFit fit;
  fit.inverse = std::move(inverse);
  fit.coefficients = fit.inverse * ProductsOfColumns(columns, weights.cwiseProduct(response));
  fit.residual = response - columns * fit.coefficients;
  // Once more on what is left: the normal equations lose half of the digits.
  const VectorXd nuisance_term = fit.inverse * ProductsOfColumns(columns, weights.cwiseProduct(fit.residual));
  fit.coefficients += nuisance_term;
  fit.residual -= columns * nuisance_term;
  fit.square_sum = weights.dot(fit.residual.cwiseAbs2());
  return fit;
}

ChannelFit FitChannel(const Eigen::Ref<const MatrixXd>& columns, const Eigen::Ref<const VectorXd>& response,
                      const Eigen::Ref<const VectorXd>& weights) {
  return FitChannel(columns, response, weights, NormalInverse(columns, weights));
}

MatrixXd SharedStep::Add(const Eigen::Ref<const MatrixXd>& columns, const MatrixXd& derivatives,
                         const ChannelFit& fit, const Eigen::Ref<const VectorXd>& weights) {
  MatrixXd weighted;
  if (!AllOne(weights)) weighted = weights.asDiagonal() * derivatives;
  const MatrixXd& own = weighted.size() > 0 ? weighted : derivatives;
  const MatrixXd common = ProductsOfColumns(columns, own);
  const MatrixXd coupling = fit.inverse * common;
  normal += ProductsOfColumns(own, derivatives) - coupling.transpose() * common;
  gradient += ProductsOfColumns(own, fit.residual);
  return -coupling;
}

}  // namespace strainwave::analysis::diagnosis
