// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/lazy_candidates.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <utility>

#include "analysis/diagnosis/refinement.h"

namespace strainwave::analysis::diagnosis {
namespace {

constexpr double kNoLimit = std::numeric_limits<double>::infinity();
constexpr double kAmongTheFirst = 0.5;  // of the largest expected, of those that are fitted first

// For white noise; of a model that is not usable there is none.
double LogLikelihoodOf(const ScoredModel& model) {
  return model.noise.log_likelihood.empty() ? 0.0 : model.noise.log_likelihood.front();
}

double RatioTo(const ScoredModel& model, const Candidate& candidate) {
  return model.noise.log_likelihood.empty() ? 0.0 : WhiteRatio(candidate.model, model);
}

}  // namespace

double LazyCandidates::Expected(std::size_t cause, const ScoredModel& model) const {
  const auto last = last_.find(cause);
  if (last == last_.end() || !judge_.study().CachesSearches()) return kNoLimit;
  const auto& [likelihood_ratio, log_likelihood] = last->second;
  const double samples = judge_.samples();
  const double shrunk = 2.0 * (LogLikelihoodOf(model) - log_likelihood) / samples;
  const double share = -std::expm1(-likelihood_ratio / samples) * std::exp(std::clamp(shrunk, 0.0, 700.0));
  return share < 1.0 ? -samples * std::log1p(-share) : kNoLimit;
}

void LazyCandidates::Fit(const ScoredModel& model, double least, std::vector<Candidate>& candidates) {
  const auto is_out = [&](std::size_t cause) {
    const auto expected = expected_.find(cause);
    return expected == expected_.end() || expected->second < least;
  };
  std::vector<Candidate> fitted = FitCandidates(judge_, model, is_out, begins_);
  for (const auto& [cause, likelihood_ratio] : expected_) {
    if (likelihood_ratio >= least) last_[cause] = {0.0, LogLikelihoodOf(model)};
  }
  std::erase_if(expected_, [&](const auto& cause) { return !is_out(cause.first); });
  for (Candidate& candidate : fitted) {
    last_[candidate.cause].likelihood_ratio = RatioTo(model, candidate);
    candidates.push_back(std::move(candidate));
  }
}

std::vector<Candidate> LazyCandidates::Strongest(const ScoredModel& model) {
  expected_.clear();
  double largest = 0.0;
  for (std::size_t cause = 0; cause < judge_.study().causes().size(); ++cause) {
    if (!MayStandBeside(judge_.study(), model.fit, cause)) continue;
    const double expected = expected_[cause] = Expected(cause, model);
    if (expected < kNoLimit) largest = std::max(largest, expected);
  }
  std::vector<Candidate> candidates;
  Fit(model, kAmongTheFirst * largest, candidates);
  double best = 0.0;
  for (const Candidate& candidate : candidates) best = std::max(best, RatioTo(model, candidate));
  Fit(model, kNowhereNear * best, candidates);
  return candidates;
}

bool LazyCandidates::AddOthers(const ScoredModel& model, const Candidate* chosen,
                               std::vector<Candidate>& candidates) {
  const double least = chosen == nullptr ? 0.0 : kNowhereNear * RatioTo(model, *chosen);
  const auto may_come_near = [&](const auto& cause) { return cause.second >= least; };
  if (std::ranges::none_of(expected_, may_come_near)) return false;
  Fit(model, least, candidates);
  return true;
}

}  // namespace strainwave::analysis::diagnosis
