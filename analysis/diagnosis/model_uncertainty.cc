// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/model_uncertainty.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include "analysis/diagnosis/residuals.h"
#include "analysis/noise_level.h"

namespace strainwave::analysis::diagnosis {
namespace {

// Multiples of the model uncertainty's variance that are tried, in that of the noise: each half the last.
constexpr double kMostShare = 16.0;
constexpr int kShares = 24;
constexpr std::size_t kApart = 2;     // samples between two events
constexpr std::size_t kEvents = 10;   // of which one may be all that tells
constexpr double kStandsOff = 6.0;    // variances of the noise
constexpr double kEnough = 0.25;      // of a likelihood ratio, that is left
constexpr double kLeastRatio = 12.0;  // of the likelihood, that model uncertainty has to be ahead of none

// By the roots of the weights: noise is then alike everywhere.
std::vector<double> Whitened(std::vector<double> values, std::span<const double> weights) {
  for (std::size_t i = 0; i < values.size(); ++i) values[i] *= std::sqrt(weights[i]);
  return values;
}

// How many times the model uncertainty's variance is added to the noise's, by maximum likelihood of what is
// left; 0 where that is hardly ahead of none.
// @param samples  with a weight
double LikeliestShare(std::span<const double> model_uncertainty, std::span<const double> left, double samples,
                      double variance) {
  // −2 log-likelihood.
  const auto cost = [&](double share) {
    double squares = 0.0;
    double logarithms = 0.0;
    for (std::size_t i = 0; i < left.size(); ++i) {
      const double growth = 1.0 + share * model_uncertainty[i] * model_uncertainty[i];
      squares += left[i] * left[i] / growth;
      logarithms += std::log(growth);
    }
    return samples * std::log(std::max(squares, 1e-300)) + logarithms;
  };
  double least = cost(0.0) - kLeastRatio;
  double best = 0.0;
  double share = kMostShare / variance;
  for (int k = 0; k < kShares; ++k, share *= 0.5) {
    const double at = cost(share);
    if (!(at < least)) continue;
    least = at;
    best = share;
  }
  return best;
}

// Of the events in which the model uncertainty is more than the noise, those few that tell most for the
// richer model.
std::vector<bool> MostTelling(std::span<const double> model_uncertainty, std::span<const double> left,
                              std::span<const double> left_without, double variance) {
  struct Event {
    double gain{};
    std::size_t first{};
    std::size_t end{};
  };
  std::vector<Event> events;
  for (std::size_t i = 0; i < model_uncertainty.size(); ++i) {
    if (!(model_uncertainty[i] * model_uncertainty[i] > variance)) continue;
    if (events.empty() || events.back().end + kApart < i) events.push_back({0.0, i, i + 1});
    events.back().end = i + 1;
    events.back().gain += left_without[i] * left_without[i] - left[i] * left[i];
  }
  std::ranges::sort(events, std::ranges::greater(), &Event::gain);
  events.resize(events.size() / kEvents);
  std::vector<bool> telling(model_uncertainty.size(), false);
  for (const Event& event : events)
    std::fill(telling.begin() + static_cast<std::ptrdiff_t>(event.first),
              telling.begin() + static_cast<std::ptrdiff_t>(event.end), true);
  return telling;
}

// Weights in which uncertain samples count for less; empty where that changes nothing.
std::vector<double> WeightsInModelUncertainty(const Judge& judge, const ScoredModel& model,
                                              const ScoredModel& without) {
  const std::span<const double> weights = judge.weights();
  const std::vector<double> model_uncertainty =
      Whitened(judge.study().ModelUncertainty(without.fit), weights);
  if (model_uncertainty.empty()) return {};
  const std::vector<double> left = Whitened(ResidualsOf(judge.study(), model.fit), weights);
  const std::vector<double> left_without = Whitened(ResidualsOf(judge.study(), without.fit), weights);
  const double deviation = RobustStandardDeviation(left);
  const double variance = std::max(deviation * deviation, 1e-300);
  const double share = LikeliestShare(model_uncertainty, left, judge.samples(), variance);
  const std::vector<bool> telling = MostTelling(model_uncertainty, left, left_without, variance);
  bool some = share > 0.0;
  std::vector<double> less(weights.begin(), weights.end());
  for (std::size_t i = 0; i < less.size(); ++i) {
    const double all = model_uncertainty[i] * model_uncertainty[i];
    // That one alone may be as wrong as that.
    const double own =
        (telling[i] ? all : std::min(all, left[i] * left[i] - kStandsOff * variance)) / variance;
    some = some || own > 1.0;
    less[i] /= 1.0 + std::max({share * all, own, 0.0});
  }
  if (!some) less.clear();
  return less;
}

}  // namespace

bool IsUncertain(const Judge& judge, const ScoredModel& model, const ScoredModel& without, std::size_t cause,
                 double error_allowed) {
  std::vector<double> weights = WeightsInModelUncertainty(judge, model, without);
  if (weights.empty()) return false;
  const Judge uncertain(judge.study(), std::move(weights), {});
  const ScoredModel with = uncertain.Fit(model.fit.causes, &model.fit);
  const ScoredModel rest = uncertain.Fit(without.fit.causes, &without.fit);
  if (!with.fit.usable || !rest.fit.usable) return false;
  const Comparison comparison = uncertain.Compare(with, rest);
  if (comparison.likelihood_ratio > kEnough * judge.Compare(model, without).likelihood_ratio) return false;
  const CauseRule& rule = judge.study().causes()[cause];
  return !IsBeyondChance(comparison, rule, uncertain.Corrected(comparison.p_value, rule), error_allowed);
}

}  // namespace strainwave::analysis::diagnosis
