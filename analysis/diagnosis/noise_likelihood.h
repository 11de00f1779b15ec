// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>
#include <cstddef>
#include <span>
#include <vector>

namespace strainwave::analysis::diagnosis {

/// Gaussian autoregressive noise, fitted to a residual.
struct NoiseFit {
  int order{};                       // of the best model by BIC
  std::vector<double> coefficients;  // x[i] = Σ cₖ x[i−k] + innovation, of that order
  double innovation_sd{};
  std::size_t samples{};               // with weight
  std::vector<double> log_likelihood;  // by order, 0 to the largest tried
};

/// Fits orders 0 to `largest_order` by conditional least squares to the residual times the roots of the
/// weights (what the weights themselves bring to the likelihood is the same for all models and left out);
/// samples without weight are gaps, and so are the ends of segments: a sample with a gap among its lags is
/// predicted by the shorter ones. A residual of exact zeros has an infinite likelihood; it is held at
/// 1e-12 of `scale`.
NoiseFit FitNoise(std::span<const double> residual, std::span<const double> weights,
                  std::span<const std::size_t> segments, int largest_order, double scale);

/// Twice the log-likelihood that `richer` is ahead of `poorer`, each under its own noise of one and the same
/// order: the best one of the richer model, or, where the poorer does better with more memory, that one less
/// what BIC charges for it.
double LikelihoodRatio(const NoiseFit& richer, const NoiseFit& poorer);

}  // namespace strainwave::analysis::diagnosis
