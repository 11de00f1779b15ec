// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include <Eigen/Core>

#include "analysis/networks/network.h"

namespace strainwave::analysis::explanation {

struct ExpectedGradients {
  Eigen::MatrixXd shares;           // inputs × outputs
  Eigen::MatrixXd standard_errors;  // of the draws
  Eigen::VectorXd
      gap;  // of each output: f(x) − mean f(background) less the sum of its shares; shrinks with more draws
};

/// What each input of a smooth network of dense layers adds on the way from a background row to the sample:
///
///   φ_i = E over rows b and α in 0…1 of (x_i − b_i) ∂f/∂x_i (b + α (x − b))
///
/// by `draws` draws, every row as often as the others, α spread evenly over its range.
/// @param sample      scaled as the network takes it.
/// @param background  inputs × rows.
/// @throws std::invalid_argument if a layer is not dense, sizes differ, or there are fewer than 2 draws.
///
/// Source: docs/sources.md#erion-2021.
ExpectedGradients ExpectedGradientsOf(const networks::Network& network,
                                      const networks::Vector<double>& parameters,
                                      const Eigen::VectorXd& sample, const Eigen::MatrixXd& background,
                                      int draws, std::uint64_t seed);

}  // namespace strainwave::analysis::explanation
