// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

#include "analysis/networks/network.h"

namespace strainwave::analysis::networks {

/// With y the target and p what the network gives, means over all outputs of all samples:
enum class Loss {
  kMape,          // 100 |(p − y) / y|, percent; y other than 0
  kMse,           // (p − y)²
  kMae,           // |p − y|
  kCrossEntropy,  // −∑ y log softmax(p) over the outputs, mean over the samples; y shares that sum to 1
};

/// @throws std::invalid_argument for any other name than mape, mse, mae and cross_entropy.
Loss LossOf(std::string_view name);

/// What `count` samples of a batch of `batch` contribute to the batch's mean, and its gradient.
/// @param predicted, target  outputs × count.
/// @param gradient  sized and filled; nullptr where nobody asks for it. Where |·| has no slope it is 0.
template <typename Scalar>
double LossShare(Loss loss, const Eigen::Ref<const Matrix<Scalar>>& predicted,
                 const Eigen::Ref<const Matrix<Scalar>>& target, Eigen::Index batch,
                 Matrix<Scalar>* gradient);

}  // namespace strainwave::analysis::networks
