// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <random>

#include "analysis/prediction/fit_predictor.h"

namespace strainwave::bench {

inline Eigen::MatrixXd Normal(Eigen::Index rows, Eigen::Index columns, std::mt19937& engine) {
  std::normal_distribution<double> normal;
  return Eigen::MatrixXd::NullaryExpr(rows, columns, [&] { return normal(engine); });
}

enum class Head { kValues, kClasses };

// A predictor of random numbers: nothing in it agrees by chance.
inline analysis::prediction::FittedPredictor RandomPredictor(const analysis::networks::Design& design,
                                                             int members, Head head = Head::kValues,
                                                             bool beside_line = false) {
  namespace networks = analysis::networks;
  std::mt19937 engine(7);
  networks::Network network(design);
  const Eigen::Index inputs = network.input_size();
  const Eigen::Index outputs = network.output_size();
  analysis::prediction::FittedPredictor fitted{
      .ensemble = {.input = {Normal(1, inputs, engine), Normal(1, inputs, engine).array().abs() + 0.5},
                   .output = {Normal(1, outputs, engine).array() + 50.0, Normal(1, outputs, engine)},
                   .network = network,
                   .members = {},
                   .softmax = head == Head::kClasses},
      .residual = Normal(1, outputs, engine).array().abs() + 0.1,
      .band = {.coverage = 0.9, .factor = Normal(1, outputs, engine).array().abs() + 1.0, .guaranteed = true},
      .novelty = {.mean = Normal(1, inputs, engine),
                  .whitening = Normal(inputs, inputs, engine),
                  .limit = 1.7},
      .least = Eigen::RowVectorXd::Zero(inputs),
      .greatest = Eigen::RowVectorXd::Ones(inputs)};
  for (int k = 0; k < members; ++k) {
    fitted.ensemble.members.push_back(
        networks::InitialParameters<double>(network, static_cast<std::uint64_t>(k)));
    fitted.ensemble.members.back() += 0.1 * Normal(network.parameter_count(), 1, engine);
  }
  if (beside_line) {
    // Limits that some inputs are beyond.
    const Eigen::RowVectorXd middle = Normal(1, inputs, engine);
    fitted.ensemble.line = {Normal(inputs, outputs, engine), middle.array() - 0.7, middle.array() + 0.7};
  }
  return fitted;
}

}  // namespace strainwave::bench
