// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/combinations.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <set>
#include <string>
#include <utility>

#include "analysis/diagnosis/cause_sets.h"
#include "analysis/diagnosis/refinement.h"

namespace strainwave::analysis::diagnosis {
namespace {

constexpr double kPairAhead = 8.0;  // of two causes, to take the place of one
constexpr std::size_t kMostTogether = 3;
constexpr std::size_t kMostFirsts = 3;
constexpr std::size_t kMostFirstsOfNuisanceTerm = 2;  // there are many where formulae fit badly

// The strongest in the place of a cause of a model: the first of two that may stand there.
std::vector<Candidate> FirstsOf(const Judge& judge, const ScoredModel& without, std::size_t cause,
                                std::span<const Candidate> beside, double error,
                                const std::function<bool(std::size_t)>& is_out) {
  const auto& rules = judge.study().causes();
  std::vector<Candidate> firsts = FitCandidates(judge, without, is_out);
  // What neither of two explains alone may pass for the noise's autocorrelation: a nuisance term holds both.
  const bool described = IsNuisanceTerm(rules[cause]);
  const std::size_t most = described ? kMostFirstsOfNuisanceTerm : kMostFirsts;
  if (!described)
    std::erase_if(firsts, [&](const Candidate& part) { return !LooksPossible(judge, part, error); });
  std::ranges::sort(firsts, std::greater<>(),
                    [&](const Candidate& part) { return WhiteRatio(part.model, without); });
  firsts.resize(std::min(firsts.size(), most));
  if (!described) return firsts;
  const auto shows = std::ranges::find_if(beside, [&](const Candidate& part) {
    return rules[part.cause].named && LooksPossible(judge, part, error);
  });
  if (shows == beside.end() || std::ranges::find(firsts, shows->cause, &Candidate::cause) != firsts.end())
    return firsts;
  Candidate first = FitCandidate(judge, without, shows->cause);
  if (!first.model.fit.usable) return firsts;
  if (firsts.size() == most) firsts.pop_back();
  firsts.push_back(std::move(first));
  return firsts;
}

// Whether a cause of a model passes and would not be dropped again as a misfit of the others.
bool Stands(const Judge& judge, std::span<const std::size_t> given, const ScoredModel& model,
            const ScoredModel& without, std::size_t cause, double error) {
  return JudgeCause(judge, model, without, cause, error).passed &&
         !IsMisfit(judge, given, model, without, cause);
}

}  // namespace

std::optional<ScoredModel> FindTogether(const Judge& judge, std::span<const std::size_t> given,
                                        const ScoredModel& model, std::size_t most, double error) {
  if (model.noise.order == 0) return std::nullopt;
  const auto& rules = judge.study().causes();
  const auto white = [&](const Candidate& candidate, const ScoredModel& poorer) {
    const CauseRule& rule = rules[candidate.cause];
    const double ahead = WhiteRatio(candidate.model, poorer);
    const int more = candidate.model.fit.free_parameters - poorer.fit.free_parameters;
    // Without a discount for search locations: autoregressive noise has lines and windows anywhere.
    return ahead - 2.0 * std::log(std::max(1.0, rule.trials_factor)) - more * std::log(judge.samples()) -
           (IsNuisanceTerm(rule) ? LeadAsked(ahead) : 0.0);
  };
  ScoredModel all = model;
  while (all.fit.causes.size() < model.fit.causes.size() + std::min(most, kMostTogether)) {
    std::vector<Candidate> candidates = FitCandidates(judge, all);
    const auto best = std::max_element(
        candidates.begin(), candidates.end(),
        [&](const Candidate& a, const Candidate& b) { return white(a, all) < white(b, all); });
    if (best == candidates.end() || white(*best, all) < kClearlyBetter) break;
    all = std::move(best->model);
  }
  while (all.fit.causes.size() > model.fit.causes.size()) {
    std::vector<Candidate> rest;  // without one each
    for (const std::size_t cause : all.fit.causes) {
      if (Contains(model.fit.causes, cause)) continue;
      rest.push_back({cause, judge.Fit(Without(all.fit.causes, cause), &all.fit), {}, 0.0});
      rest.back().against = judge.Compare(all, rest.back().model);
    }
    std::sort(rest.begin(), rest.end(), [](const Candidate& a, const Candidate& b) {
      return a.against.delta_bic < b.against.delta_bic;
    });
    // The weakest of what is not beyond chance, which is cheap to say; else of what fails otherwise.
    auto weakest = std::find_if(rest.begin(), rest.end(), [&](const Candidate& without) {
      return !LooksPossible(judge, without, error);
    });
    if (weakest == rest.end()) {
      weakest = std::find_if(rest.begin(), rest.end(), [&](const Candidate& without) {
        return !Stands(judge, given, all, without.model, without.cause, error);
      });
    }
    if (weakest == rest.end()) return all;
    all = std::move(weakest->model);
  }
  return std::nullopt;
}

std::optional<ScoredModel> FindPair(const Judge& judge, std::span<const std::size_t> given,
                                    const ScoredModel& model, std::span<const Candidate> beside, double error,
                                    const DominatedBy& dominated, PairRivals& rivals) {
  const auto& rules = judge.study().causes();
  const bool many = model.fit.causes.size() > given.size() + kFewEffects;
  rivals.clear();
  std::optional<ScoredModel> best;
  double most = 0.0;
  for (const std::size_t cause : model.fit.causes) {
    if (Contains(given, cause) || (many && IsNuisanceTerm(rules[cause]))) continue;
    const ScoredModel without = judge.Fit(Without(model.fit.causes, cause), &model.fit);
    if (!without.fit.usable) continue;
    const double own = ScoreOf(judge, model, without, cause);
    // A nuisance term has to be better than causes, not they than it.
    const double asked = rules[cause].named ? kPairAhead : 0.0;
    const std::vector<Candidate> firsts =
        FirstsOf(judge, without, cause, beside, error, [&](std::size_t part) {
          return part == cause || !rules[part].named || IsDominated(dominated, cause, part);
        });
    std::set<std::string> pairs;
    for (const Candidate& first : firsts) {
      // All of them, the cause itself in another form as well: what the first one hid may show beside it
      // alone.
      for (Candidate& second :
           FitCandidates(judge, first.model, [&](std::size_t part) { return !rules[part].named; })) {
        ScoredModel& pair = second.model;
        const double lead = first.score + second.score - own;
        if (lead < -kAsGood) continue;
        const ScoredModel reported = judge.Fit(pair.fit.causes, &pair.fit, FitPurpose::kJudge);
        const auto unlikely = [&](std::size_t part) {
          return !judge.Objection(reported.fit, part, kNotExcluded).empty();
        };
        if (unlikely(first.cause) || unlikely(second.cause)) continue;
        if (second.cause != cause) {
          const auto [one, other] = std::minmax(first.cause, second.cause);
          pairs.insert(rules[one].name + " + " + rules[other].name);
        }
        if (lead - asked < most || !Stands(judge, given, pair, first.model, second.cause, error)) continue;
        const ScoredModel other = judge.Fit(Without(pair.fit.causes, first.cause), &pair.fit);
        if (!Stands(judge, given, pair, other, first.cause, error)) continue;
        most = lead - asked;
        best = std::move(pair);
      }
    }
    rivals[cause].assign(pairs.begin(), pairs.end());
  }
  return best;
}

}  // namespace strainwave::analysis::diagnosis
