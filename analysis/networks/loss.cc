// SPDX-License-Identifier: Apache-2.0
#include "analysis/networks/loss.h"

#include <fmt/format.h>

#include <stdexcept>

namespace strainwave::analysis::networks {
namespace {

using Eigen::Index;

template <typename Scalar>
double CrossEntropy(const Eigen::Ref<const Matrix<Scalar>>& predicted,
                    const Eigen::Ref<const Matrix<Scalar>>& target, Scalar scale, Matrix<Scalar>* gradient) {
  double sum = 0.0;
  for (Index sample = 0; sample < predicted.cols(); ++sample) {
    const auto p = predicted.col(sample).array();
    const auto y = target.col(sample).array();
    const Scalar top = p.maxCoeff();
    const Scalar log_total = top + std::log((p - top).exp().sum());
    sum -= static_cast<double>((y * (p - log_total)).sum());
    if (gradient == nullptr) continue;
    gradient->col(sample) = scale * (y.sum() * (p - log_total).exp() - y).matrix();
  }
  return static_cast<double>(scale) * sum;
}

}  // namespace

Loss LossOf(std::string_view name) {
  if (name == "mape") return Loss::kMape;
  if (name == "mse") return Loss::kMse;
  if (name == "mae") return Loss::kMae;
  if (name == "cross_entropy") return Loss::kCrossEntropy;
  throw std::invalid_argument(
      fmt::format("loss = '{}' is not known (expected mape, mse, mae or cross_entropy)", name));
}

template <typename Scalar>
double LossShare(Loss loss, const Eigen::Ref<const Matrix<Scalar>>& predicted,
                 const Eigen::Ref<const Matrix<Scalar>>& target, Index batch, Matrix<Scalar>* gradient) {
  if (predicted.rows() != target.rows() || predicted.cols() != target.cols()) {
    throw std::invalid_argument(fmt::format("target is {} × {} (expected {} × {})", target.rows(),
                                            target.cols(), predicted.rows(), predicted.cols()));
  }
  if (gradient != nullptr) gradient->resize(predicted.rows(), predicted.cols());
  if (loss == Loss::kCrossEntropy) {
    return CrossEntropy<Scalar>(predicted, target, Scalar(1) / static_cast<Scalar>(batch), gradient);
  }
  const double values = static_cast<double>(batch) * static_cast<double>(predicted.rows());
  const auto share = static_cast<Scalar>((loss == Loss::kMape ? 100.0 : 1.0) / values);
  const auto error = predicted.array() - target.array();
  switch (loss) {
    case Loss::kMape:
      if (gradient != nullptr) gradient->array() = share * error.sign() / target.array().abs();
      return static_cast<double>((error / target.array()).abs().sum() * share);
    case Loss::kMse:
      if (gradient != nullptr) gradient->array() = Scalar(2) * share * error;
      return static_cast<double>(error.square().sum() * share);
    case Loss::kMae:
      if (gradient != nullptr) gradient->array() = share * error.sign();
      return static_cast<double>(error.abs().sum() * share);
    case Loss::kCrossEntropy:
      break;
  }
  return 0.0;
}

template double LossShare(Loss, const Eigen::Ref<const Matrix<float>>&,
                          const Eigen::Ref<const Matrix<float>>&, Index, Matrix<float>*);
template double LossShare(Loss, const Eigen::Ref<const Matrix<double>>&,
                          const Eigen::Ref<const Matrix<double>>&, Index, Matrix<double>*);

}  // namespace strainwave::analysis::networks
