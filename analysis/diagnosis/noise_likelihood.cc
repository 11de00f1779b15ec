// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/noise_likelihood.h"

#include <algorithm>
#include <cmath>

#include "analysis/units.h"

namespace strainwave::analysis::diagnosis {
namespace {

using Eigen::Index;

// How many good neighbours each sample has right before it, up to `largest`.
std::vector<int> LagsBefore(std::span<const double> weights, std::span<const std::size_t> stretches,
                            int largest) {
  std::vector<int> lags(weights.size(), 0);
  std::size_t stretch = 0;
  int run = 0;
  for (std::size_t i = 0; i < weights.size(); ++i) {
    if (stretch < stretches.size() && stretches[stretch] == i) {
      run = 0;
      ++stretch;
    }
    lags[i] = std::min(run, largest);
    run = weights[i] > 0.0 ? run + 1 : 0;
  }
  return lags;
}

}  // namespace

NoiseFit FitNoise(std::span<const double> unweighted, std::span<const double> weights,
                  std::span<const std::size_t> stretches, int largest_order, double scale) {
  NoiseFit fit;
  std::vector<double> residual(unweighted.begin(), unweighted.end());
  for (std::size_t i = 0; i < residual.size(); ++i) residual[i] *= std::sqrt(std::max(0.0, weights[i]));
  const std::vector<int> lags = LagsBefore(weights, stretches, largest_order);
  const double least_variance = 1e-24 * scale * scale;
  double square_sum = 0.0;
  for (std::size_t i = 0; i < residual.size(); ++i) {
    if (!(weights[i] > 0.0)) continue;
    ++fit.samples;
    square_sum += residual[i] * residual[i];
  }
  const auto n = static_cast<double>(fit.samples);
  if (fit.samples == 0) return fit;
  const double variance = std::max(square_sum / n, least_variance);
  fit.log_likelihood.push_back(-0.5 * n * (std::log(kTwoPi * variance) + 1.0));
  fit.innovation_sd = std::sqrt(variance);

  // Cross products of lagged samples where all lags of the largest order are there; every order from these.
  const Index size = largest_order + 1;
  Eigen::MatrixXd products = Eigen::MatrixXd::Zero(size, size);
  double rows = 0.0;
  for (std::size_t i = 0; i < residual.size(); ++i) {
    if (!(weights[i] > 0.0) || lags[i] < largest_order) continue;
    rows += 1.0;
    for (Index a = 0; a < size; ++a) {
      const double x = residual[i - static_cast<std::size_t>(a)];
      for (Index b = 0; b <= a; ++b) products(a, b) += x * residual[i - static_cast<std::size_t>(b)];
    }
  }
  products = Eigen::MatrixXd(products.selfadjointView<Eigen::Lower>());
  double best = fit.log_likelihood[0];
  if (rows < 10.0 * static_cast<double>(size)) return fit;
  for (Index order = 1; order <= largest_order; ++order) {
    const Eigen::VectorXd cross = products.col(0).segment(1, order);
    const Eigen::VectorXd coefficients = products.block(1, 1, order, order).ldlt().solve(cross);
    // Share of the variance that the lags do not foretell; the samples without them have all of it.
    const double share = 1.0 - coefficients.dot(cross) / std::max(products(0, 0), least_variance);
    const double innovation = std::max(share * variance, least_variance);
    const double likelihood = fit.log_likelihood[0] + 0.5 * rows * std::log(variance / innovation);
    fit.log_likelihood.push_back(likelihood);
    const double penalised = likelihood - 0.5 * static_cast<double>(order) * std::log(n);
    if (penalised > best && innovation < variance) {
      best = penalised;
      fit.order = static_cast<int>(order);
      fit.coefficients.assign(coefficients.data(), coefficients.data() + order);
      fit.innovation_sd = std::sqrt(innovation);
    }
  }
  return fit;
}

double LikelihoodRatio(const NoiseFit& richer, const NoiseFit& poorer) {
  if (richer.log_likelihood.empty() || poorer.log_likelihood.empty()) return 0.0;
  const double charge = 0.5 * std::log(static_cast<double>(std::max<std::size_t>(richer.samples, 1)));
  const auto base = static_cast<std::size_t>(richer.order);
  double ahead = 1e300;
  for (const std::size_t order : {base, static_cast<std::size_t>(poorer.order)}) {
    if (order >= richer.log_likelihood.size() || order >= poorer.log_likelihood.size()) continue;
    const double extra = charge * (static_cast<double>(order) - static_cast<double>(base));
    ahead = std::min(ahead, richer.log_likelihood[base] - (poorer.log_likelihood[order] - extra));
  }
  return 2.0 * ahead;
}

}  // namespace strainwave::analysis::diagnosis
