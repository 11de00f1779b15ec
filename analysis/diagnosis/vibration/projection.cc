// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/vibration/projection.h"

#include <cmath>
#include <utility>

#include "analysis/decompositions.h"

namespace strainwave::analysis::diagnosis {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

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

ChannelFit FitChannel(const Eigen::Ref<const MatrixXd>& columns, const VectorXd& response,
                      const VectorXd& weights, MatrixXd inverse) {
  ChannelFit fit;
  fit.inverse = std::move(inverse);
  fit.coefficients = fit.inverse * (columns.transpose() * weights.cwiseProduct(response));
  fit.residual = response - columns * fit.coefficients;
  // Once more on what is left: the normal equations lose half of the digits.
  const VectorXd correction = fit.inverse * (columns.transpose() * weights.cwiseProduct(fit.residual));
  fit.coefficients += correction;
  fit.residual -= columns * correction;
  fit.square_sum = weights.dot(fit.residual.cwiseAbs2());
  return fit;
}

ChannelFit FitChannel(const Eigen::Ref<const MatrixXd>& columns, const VectorXd& response,
                      const VectorXd& weights) {
  MatrixXd normal = MatrixXd::Zero(columns.cols(), columns.cols());
  const VectorXd root = weights.cwiseSqrt();
  if ((root.array() == 1.0).all()) {
    normal.selfadjointView<Eigen::Lower>().rankUpdate(columns.transpose());
  } else {
    normal.selfadjointView<Eigen::Lower>().rankUpdate((root.asDiagonal() * columns).transpose().eval());
  }
  return FitChannel(columns, response, weights, PseudoInverse(normal.selfadjointView<Eigen::Lower>()));
}

MatrixXd SharedStep::Add(const Eigen::Ref<const MatrixXd>& columns, const MatrixXd& derivatives,
                         const ChannelFit& fit, const VectorXd& weights) {
  const MatrixXd weighted = weights.asDiagonal() * derivatives;
  const MatrixXd common = columns.transpose() * weighted;
  const MatrixXd coupling = fit.inverse * common;
  normal.noalias() += weighted.transpose() * derivatives - coupling.transpose() * common;
  gradient.noalias() += weighted.transpose() * fit.residual;
  return -coupling;
}

}  // namespace strainwave::analysis::diagnosis
