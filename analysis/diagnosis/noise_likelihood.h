// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

namespace strainwave::analysis::diagnosis {

/// x[i] = Σ cₖ x[i−k] + innovation.
struct Autoregression {
  std::vector<double> coefficients;
  double innovation_sd{};
  std::size_t samples{};  // with weight
};

/// Gaussian autoregressive noise, fitted to a residual.
struct NoiseFit {
  int order{};                         // of the best model by BIC, the same in all series
  std::vector<Autoregression> series;  // of that order; one at least where a sample has weight
  double innovation_sd{};              // over all series
  std::size_t samples{};               // with weight
  std::vector<double> log_likelihood;  // by order, 0 to the largest tried

  /// Parameters that one more order costs.
  double per_order() const { return static_cast<double>(std::max<std::size_t>(1, series.size())); }
};

/// Fits orders 0 to `largest_order` by conditional least squares to the residual times the roots of the
/// weights (what the weights themselves bring to the likelihood is the same for all models and left out);
/// samples without weight are gaps, and so are the ends of segments: a sample with a gap among its lags is
/// predicted by the shorter ones. A residual of exact zeros has an infinite likelihood; it is held at
/// 1e-12 of `scale`.
/// @param series  first samples of what has a spectrum and a variance of its own, ascending from 0, each the
///                start of a segment; empty: all samples are one series
NoiseFit FitNoise(std::span<const double> residual, std::span<const double> weights,
                  std::span<const std::size_t> segments, int largest_order, double scale,
                  std::span<const std::size_t> series = {});

/// Twice the log-likelihood that `richer` is ahead of `poorer`, each under its own noise of one and the same
/// order: the best one of the richer model, or, where the poorer does better with a stronger autocorrelation,
/// that one less what BIC charges for it.
double LikelihoodRatio(const NoiseFit& richer, const NoiseFit& poorer);

}  // namespace strainwave::analysis::diagnosis
