// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/doubt.h"

#include <algorithm>
#include <cmath>

#include "analysis/diagnosis/residuals.h"
#include "analysis/noise_level.h"

namespace strainwave::analysis::diagnosis {
namespace {

// Multiples of the doubt's variance that are tried, in that of the noise: each half the last.
constexpr double kMostShare = 16.0;
constexpr int kShares = 24;
constexpr double kStandsOff = 6.0;    // variances of the noise
constexpr double kLeastRatio = 12.0;  // of the likelihood, that doubt has to be ahead of none

std::vector<double> Weighted(std::vector<double> values, std::span<const double> weights) {
  for (std::size_t i = 0; i < values.size(); ++i) values[i] *= std::sqrt(weights[i]);
  return values;
}

}  // namespace

std::vector<double> WeightsInDoubt(const Judge& judge, const ScoredModel& model, const ScoredModel& without) {
  const std::vector<double> doubt = judge.study().Doubt(without.fit);
  if (doubt.empty()) return {};
  const std::vector<double> left = ResidualsOf(judge.study(), model.fit);
  const std::span<const double> weights = judge.weights();
  // −2 log-likelihood of white noise whose variance grows with the doubt's, by this share of it.
  const auto cost = [&](double share) {
    double squares = 0.0;
    double logarithms = 0.0;
    for (std::size_t i = 0; i < left.size(); ++i) {
      if (!(weights[i] > 0.0)) continue;
      const double growth = 1.0 + share * weights[i] * doubt[i] * doubt[i];
      squares += weights[i] * left[i] * left[i] / growth;
      logarithms += std::log(growth);
    }
    return judge.samples() * std::log(std::max(squares, 1e-300)) + logarithms;
  };
  const double deviation = RobustStandardDeviation(Weighted(left, weights));
  const double variance = std::max(deviation * deviation, 1e-300);
  double least = cost(0.0) - kLeastRatio;
  double best = 0.0;
  double share = kMostShare / variance;
  for (int k = 0; k < kShares; ++k, share *= 0.5) {
    const double at = cost(share);
    if (!(at < least)) continue;
    least = at;
    best = share;
  }
  bool some = best > 0.0;
  std::vector<double> less(weights.begin(), weights.end());
  for (std::size_t i = 0; i < less.size(); ++i) {
    const double all = weights[i] * doubt[i] * doubt[i];
    // That one alone may be as wrong as that.
    const double own = std::min(all, weights[i] * left[i] * left[i] - kStandsOff * variance) / variance;
    some = some || own > 1.0;
    less[i] /= 1.0 + std::max({best * all, own, 0.0});
  }
  if (!some) less.clear();
  return less;
}

bool IsInDoubt(const Judge& judge, const ScoredModel& model, const ScoredModel& without, std::size_t cause,
               double error_allowed) {
  std::vector<double> weights = WeightsInDoubt(judge, model, without);
  if (weights.empty()) return false;
  const Judge doubtful(judge.study(), std::move(weights), {});
  const ScoredModel with = doubtful.Fit(model.fit.causes, &model.fit);
  const ScoredModel rest = doubtful.Fit(without.fit.causes, &without.fit);
  if (!with.fit.usable || !rest.fit.usable) return false;
  const Comparison comparison = doubtful.Compare(with, rest);
  const CauseRule& rule = judge.study().causes()[cause];
  return !IsBeyondChance(comparison, rule, doubtful.Corrected(comparison.p_value, rule), error_allowed);
}

}  // namespace strainwave::analysis::diagnosis
