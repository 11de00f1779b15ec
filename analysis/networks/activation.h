// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "analysis/networks/vector_functions.h"

namespace strainwave::analysis::networks {

enum class Activation { kLinear, kRelu, kSigmoid, kTanh };

/// z becomes f(z), value by value.
template <typename Values>
void Activate(Activation activation, Eigen::PlainObjectBase<Values>& z) {
  using Scalar = typename Values::Scalar;
  switch (activation) {
    case Activation::kLinear:
      return;
    case Activation::kRelu:
      z.derived() = z.derived().cwiseMax(Scalar(0));
      return;
    case Activation::kSigmoid:
      Sigmoid(z.data(), z.size());
      return;
    case Activation::kTanh:
      Tanh(z.data(), z.size());
      return;
  }
}

/// The gradient by f(z) becomes that by z; each f's slope is told by its value. That of ReLU at 0 is 0.
template <typename Values, typename Gradient>
void MultiplyBySlope(Activation activation, const Eigen::DenseBase<Values>& value,
                     Eigen::DenseBase<Gradient>& gradient) {
  using Scalar = typename Values::Scalar;
  const auto f = value.derived().array();
  auto g = gradient.derived().array();
  switch (activation) {
    case Activation::kLinear:
      return;
    case Activation::kRelu:
      // A loop that the compiler turns into vectors; Eigen's select is none.
      for (Eigen::Index i = 0; i < f.size(); ++i) {
        gradient.derived().coeffRef(i) =
            value.derived().coeff(i) > Scalar(0) ? gradient.derived().coeff(i) : Scalar(0);
      }
      return;
    case Activation::kSigmoid:
      g *= f * (Scalar(1) - f);
      return;
    case Activation::kTanh:
      g *= Scalar(1) - f * f;
      return;
  }
}

}  // namespace strainwave::analysis::networks
