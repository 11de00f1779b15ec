// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/noise_likelihood.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "analysis/decompositions.h"
#include "analysis/products.h"
#include "analysis/units.h"

namespace strainwave::analysis::diagnosis {
namespace {

using Eigen::Index;

constexpr double kLeastVarianceShare = 1e-12;

// Samples that follow one another, all with weight and of one segment: from … to.
struct GoodRun {
  std::size_t first{};
  std::size_t last{};

  std::size_t size() const { return last - first; }
};

std::vector<GoodRun> RunsOf(std::span<const double> weights, std::span<const std::size_t> segments) {
  std::vector<GoodRun> runs;
  std::size_t segment = 0;
  bool follows = false;
  for (std::size_t i = 0; i < weights.size(); ++i) {
    if (segment < segments.size() && segments[segment] == i) {
      follows = false;
      ++segment;
    }
    const bool good = weights[i] > 0.0;
    if (good && !follows) runs.push_back({i, i});
    if (good) runs.back().last = i + 1;
    follows = good;
  }
  return runs;
}

// Predicts a sample from those right before it, and what share of the variance it leaves.
struct Predictor {
  Eigen::VectorXd coefficients;
  double share{1.0};
  double log_share{};
};

// One an order, by least squares where all lags of the largest order are there; order 0 alone where these are
// too few.
std::vector<Predictor> PredictorsOf(std::span<const double> residual, std::span<const GoodRun> runs,
                                    int largest_order) {
  const Index size = largest_order + 1;
  const auto most_lags = static_cast<std::size_t>(largest_order);
  Eigen::MatrixXd products = Eigen::MatrixXd::Zero(size, size);
  double rows = 0.0;
  for (const GoodRun& run : runs) {
    if (run.size() <= most_lags) continue;
    // The run, and itself so many samples before.
    const RowView<const double> lagged{residual.data() + run.first + most_lags, -1};
    const std::size_t count = run.size() - most_lags;
    MultiplyRows<double>(lagged, lagged, {products.data(), 1, size}, size, size,
                         static_cast<std::ptrdiff_t>(count), Sum::kAdd);
    rows += static_cast<double>(count);
  }
  std::vector<Predictor> predictors(1);
  if (rows < 10.0 * static_cast<double>(size) || !(products(0, 0) > 0.0)) return predictors;
  for (Index order = 1; order <= largest_order; ++order) {
    const Eigen::VectorXd cross = products.col(0).segment(1, order);
    const Eigen::VectorXd coefficients = SymmetricFactor(products.block(1, 1, order, order)).Solve(cross);
    const double share = 1.0 - coefficients.dot(cross) / products(0, 0);
    const double left = std::clamp(share, kLeastVarianceShare, 1.0);
    predictors.push_back({coefficients, left, std::log(left)});
  }
  return predictors;
}

// One series at each order.
struct SeriesFit {
  std::size_t samples{};
  std::vector<Autoregression> by_order;  // one where the samples are too few for more
  std::vector<double> log_likelihood;

  std::size_t At(int order) const {
    return std::min(static_cast<std::size_t>(order), log_likelihood.size() - 1);
  }
};

SeriesFit FitSeries(std::span<const double> residual, std::span<const GoodRun> runs, int largest_order,
                    double scale) {
  SeriesFit fit;
  for (const GoodRun& run : runs) fit.samples += run.size();
  const auto n = static_cast<double>(fit.samples);
  const std::vector<Predictor> predictors = PredictorsOf(residual, runs, largest_order);
  for (int order = 0; order < static_cast<int>(predictors.size()); ++order) {
    double squares = 0.0;  // as if nothing were predicted
    double logarithms = 0.0;
    const auto add = [&](std::size_t first, std::size_t last, const Predictor& predictor) {
      double sum = 0.0;
      for (std::size_t i = first; i < last; ++i) {
        double innovation = residual[i];
        for (std::size_t k = 0; k < static_cast<std::size_t>(predictor.coefficients.size()); ++k)
          innovation -= predictor.coefficients(static_cast<Index>(k)) * residual[i - 1 - k];
        sum += innovation * innovation;
      }
      squares += sum / predictor.share;
      logarithms += static_cast<double>(last - first) * predictor.log_share;
    };
    for (const GoodRun& run : runs) {
      const std::size_t all_lags = std::min(run.first + static_cast<std::size_t>(order), run.last);
      for (std::size_t i = run.first; i < all_lags; ++i) add(i, i + 1, predictors[i - run.first]);
      add(all_lags, run.last, predictors[static_cast<std::size_t>(order)]);
    }
    const double variance = std::max(squares / n, 1e-24 * scale * scale);
    fit.log_likelihood.push_back(-0.5 * (n * (std::log(kTwoPi * variance) + 1.0) + logarithms));
    const Predictor& own = predictors[static_cast<std::size_t>(order)];
    fit.by_order.push_back(
        {{own.coefficients.begin(), own.coefficients.end()}, std::sqrt(own.share * variance), fit.samples});
  }
  return fit;
}

std::vector<SeriesFit> FitAllSeries(std::span<const double> residual, std::span<const GoodRun> runs,
                                    std::span<const std::size_t> series, int largest_order, double scale) {
  std::vector<SeriesFit> fits;
  for (auto from = runs.begin(); from != runs.end();) {
    const auto next = std::upper_bound(series.begin(), series.end(), from->first);
    const std::size_t end = next == series.end() ? residual.size() : *next;
    const auto to = std::find_if(from, runs.end(), [&](const GoodRun& run) { return run.first >= end; });
    fits.push_back(FitSeries(residual, {from, to}, largest_order, scale));
    from = to;
  }
  return fits;
}

}  // namespace

NoiseFit FitNoise(std::span<const double> unweighted, std::span<const double> weights,
                  std::span<const std::size_t> segments, int largest_order, double scale,
                  std::span<const std::size_t> series) {
  NoiseFit fit;
  std::vector<double> residual(unweighted.begin(), unweighted.end());
  for (std::size_t i = 0; i < residual.size(); ++i) {
    if (weights[i] != 1.0) residual[i] *= std::sqrt(std::max(0.0, weights[i]));
  }
  const std::vector<SeriesFit> fits =
      FitAllSeries(residual, RunsOf(weights, segments), series, largest_order, scale);
  if (fits.empty()) return fit;
  std::size_t orders = 0;
  for (const SeriesFit& own : fits) {
    fit.samples += own.samples;
    orders = std::max(orders, own.log_likelihood.size());
  }
  const auto n = static_cast<double>(fit.samples);
  const double charge = 0.5 * static_cast<double>(fits.size()) * std::log(n);
  double best = 0.0;
  for (int order = 0; order < static_cast<int>(orders); ++order) {
    double together = 0.0;
    for (const SeriesFit& own : fits) together += own.log_likelihood[own.At(order)];
    fit.log_likelihood.push_back(together);
    const double penalised = together - order * charge;
    if (order > 0 && penalised <= best) continue;
    best = penalised;
    fit.order = order;
  }
  double innovations = 0.0;
  for (const SeriesFit& own : fits) {
    fit.series.push_back(own.by_order[own.At(fit.order)]);
    innovations +=
        static_cast<double>(own.samples) * fit.series.back().innovation_sd * fit.series.back().innovation_sd;
  }
  fit.innovation_sd = std::sqrt(innovations / n);
  return fit;
}

double LikelihoodRatio(const NoiseFit& richer, const NoiseFit& poorer) {
  if (richer.log_likelihood.empty() || poorer.log_likelihood.empty()) return 0.0;
  const double charge =
      0.5 * richer.per_order() * std::log(static_cast<double>(std::max<std::size_t>(richer.samples, 1)));
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
