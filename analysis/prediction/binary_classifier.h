// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include <Eigen/Core>

#include "analysis/prediction/ensemble.h"

namespace strainwave::analysis::prediction {

/// Four ways to tell two classes apart.
enum class BinaryKind { kNetwork, kForest, kSvm, kLogisticRegression };
inline constexpr BinaryKind kBinaryKinds[] = {BinaryKind::kNetwork, BinaryKind::kForest, BinaryKind::kSvm,
                                              BinaryKind::kLogisticRegression};
/// "network", "forest", "svm", "logistic_regression".
std::string_view NameOf(BinaryKind kind);

/// Above it a score means class 1: a half of a probability, 0 of a support vector machine's distance.
double ThresholdOf(BinaryKind kind);

struct BinarySettings {
  int epochs{80};
  int batch{256};
  std::uint64_t seed{42};
};

/// Dense 64 and 32, ReLU, a sigmoid at the output, binary cross-entropy, Adam with 1e-3. The sigmoid stands
/// as a softmax of two outputs: the sigmoid of their difference, under the same loss.
/// @param actual  0 or 1, one a row, both among them.
///
/// Source: docs/sources.md#actuators-2025, table 2, which trains 10 000 epochs of one batch; here they are
/// fewer and
///   in batches, since more fit the training's files and no others.
Ensemble TrainBinaryNetwork(const Eigen::MatrixXd& features, std::span<const int> actual,
                            const BinarySettings& settings = {});

/// Trains one kind and scores other rows. Inputs are standardised by the training's rows.
///   forest               100 trees, mean of what their leaves hold;
///   svm                  radial basis functions, C = 1, γ = 1 / inputs; the signed distance;
///   logistic_regression  batch gradient descent with an L2 norm, its weights on the inputs; a probability.
/// @throws std::invalid_argument if rows differ, there are fewer than 10, or only one class is there.
Eigen::VectorXd TrainAndScore(BinaryKind kind, const Eigen::MatrixXd& features, std::span<const int> actual,
                              const Eigen::MatrixXd& tested, const BinarySettings& settings = {});

}  // namespace strainwave::analysis::prediction
