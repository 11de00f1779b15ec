// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/noise_likelihood.h"

#include <algorithm>
#include <cmath>

#include "analysis/units.h"

namespace strainwave::analysis::diagnosis {
namespace {

using Eigen::Index;

constexpr double kLeastVarianceShare = 1e-12;

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

// Foretells a sample from those right before it, and what share of the variance it leaves.
struct Predictor {
  Eigen::VectorXd coefficients;
  double share{1.0};
  double log_share{};
};

// One an order, by least squares where all lags of the largest order are there; order 0 alone where these are
// too few.
std::vector<Predictor> PredictorsOf(std::span<const double> residual, std::span<const double> weights,
                                    std::span<const int> lags, int largest_order) {
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
  std::vector<Predictor> predictors(1);
  if (rows < 10.0 * static_cast<double>(size) || !(products(0, 0) > 0.0)) return predictors;
  for (Index order = 1; order <= largest_order; ++order) {
    const Eigen::VectorXd cross = products.col(0).segment(1, order);
    const Eigen::VectorXd coefficients = products.block(1, 1, order, order).ldlt().solve(cross);
    const double share = 1.0 - coefficients.dot(cross) / products(0, 0);
    const double left = std::clamp(share, kLeastVarianceShare, 1.0);
    predictors.push_back({coefficients, left, std::log(left)});
  }
  return predictors;
}

}  // namespace

NoiseFit FitNoise(std::span<const double> unweighted, std::span<const double> weights,
                  std::span<const std::size_t> stretches, int largest_order, double scale) {
  NoiseFit fit;
  std::vector<double> residual(unweighted.begin(), unweighted.end());
  for (std::size_t i = 0; i < residual.size(); ++i) {
    residual[i] *= std::sqrt(std::max(0.0, weights[i]));
    if (weights[i] > 0.0) ++fit.samples;
  }
  if (fit.samples == 0) return fit;
  const auto n = static_cast<double>(fit.samples);
  const std::vector<int> lags = LagsBefore(weights, stretches, largest_order);
  const std::vector<Predictor> predictors = PredictorsOf(residual, weights, lags, largest_order);
  double best = 0.0;
  for (int order = 0; order < static_cast<int>(predictors.size()); ++order) {
    double squares = 0.0;  // as if nothing were foretold
    double logarithms = 0.0;
    for (std::size_t i = 0; i < residual.size(); ++i) {
      if (!(weights[i] > 0.0)) continue;
      const Predictor& predictor = predictors[static_cast<std::size_t>(std::min(lags[i], order))];
      double innovation = residual[i];
      for (Index k = 0; k < predictor.coefficients.size(); ++k)
        innovation -= predictor.coefficients(k) * residual[i - 1 - static_cast<std::size_t>(k)];
      squares += innovation * innovation / predictor.share;
      logarithms += predictor.log_share;
    }
    const double variance = std::max(squares / n, 1e-24 * scale * scale);
    fit.log_likelihood.push_back(-0.5 * (n * (std::log(kTwoPi * variance) + 1.0) + logarithms));
    const double penalised = fit.log_likelihood.back() - 0.5 * order * std::log(n);
    if (order > 0 && penalised <= best) continue;
    const Predictor& own = predictors[static_cast<std::size_t>(order)];
    best = penalised;
    fit.order = order;
    fit.coefficients.assign(own.coefficients.begin(), own.coefficients.end());
    fit.innovation_sd = std::sqrt(own.share * variance);
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
