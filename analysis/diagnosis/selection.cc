// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/selection.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include "analysis/diagnosis/candidates.h"
#include "analysis/diagnosis/cause_sets.h"
#include "analysis/diagnosis/combinations.h"
#include "analysis/diagnosis/lazy_candidates.h"
#include "analysis/diagnosis/refinement.h"

namespace strainwave::analysis::diagnosis {
namespace {

constexpr double kErrorBeside = 0.15;      // of the error allowed, for what comes on top of something found
constexpr double kWithinThreeSigma = 9.0;  // of the likelihood ratio, between two causes
// A further effect has to bring this share of what all have brought: less may be the misfit of a formula.
constexpr double kLeastShare = 0.004;               // of the likelihood ratio
constexpr double kLeastShareOfNuisanceTerm = 0.01;  // of a further one

bool HasNuisanceTerm(const Judge& judge, const ScoredModel& model) {
  return std::ranges::any_of(
      model.fit.causes, [&](std::size_t cause) { return IsNuisanceTerm(judge.study().causes()[cause]); });
}

// What was dominated by a nuisance term while nothing else was known may do in its place beside what came
// later.
// @returns whether there is any such.
bool ForgetWhatIsBehindNuisanceTerms(const Judge& judge, std::span<const std::size_t> given,
                                     Selection& selection) {
  const std::size_t effects = selection.model.fit.causes.size() - given.size();
  if (effects < 2 || effects > kFewEffects) return false;
  std::size_t forgotten = 0;
  for (const std::size_t cause : selection.model.fit.causes) {
    if (IsNuisanceTerm(judge.study().causes()[cause])) forgotten += selection.dominated.erase(cause);
  }
  return forgotten > 0;
}

// Share of clean records in which this may be found. What comes on top of something found has to be clearer:
// it may be the misfit of a formula that is not nature's.
double ErrorAllowed(const ScoredModel& model, std::size_t given, const DiagnoseOptions& options) {
  return model.fit.causes.size() > given ? kErrorBeside * options.family_error : options.family_error;
}

// Judges candidates in their order, of which the first that passes is the next effect.
// @param judged  gets what was said of each
// @returns that one, or null.
const Candidate* ChooseNext(const Judge& judge, std::span<const std::size_t> given, const ScoredModel& model,
                            const std::vector<Candidate>& candidates, double explained, bool full,
                            double error, std::map<std::size_t, CandidateResult>& judged) {
  const auto& rules = judge.study().causes();
  const Candidate* chosen = nullptr;
  const bool beside = model.fit.causes.size() > given.size();
  const bool lacks = std::ranges::any_of(
      model.fit.causes, [&](std::size_t cause) { return !rules[cause].named && !Contains(given, cause); });
  judged.clear();
  for (const Candidate& candidate : candidates) {
    const CauseRule& rule = rules[candidate.cause];
    CandidateResult result{
        candidate.cause,
        {DeltaBic(candidate.against, rule), judge.Corrected(candidate.against.p_value, rule), 0.0},
        false,
        "not beyond chance"};
    if (chosen == nullptr && !full && LooksPossible(judge, candidate, error)) {
      result = JudgeCause(judge, candidate.model, model, candidate.cause, error);
      if (result.passed &&
          ((beside && result.evidence.delta_bic < LeastBicBeside(rule)) ||
           candidate.against.likelihood_ratio <
               (lacks && !rule.named ? kLeastShareOfNuisanceTerm : kLeastShare) * explained ||
           IsMisfit(judge, given, candidate.model, model, candidate.cause))) {
        result.passed = false;
        result.objection = "too small beside what was found already to be told from a misfit of its formula";
      } else if (result.passed) {
        if (auto departure = DepartureInstead(judge, given, candidate.model, model, candidate.cause)) {
          result.passed = false;
          result.objection = std::move(*departure);
        }
      }
      if (result.passed) chosen = &candidate;
    } else if (LooksPossible(judge, candidate, error)) {
      result.objection = "another candidate explains more";
    }
    judged[candidate.cause] = std::move(result);
  }
  return chosen;
}

// How many rounds there will be nobody knows: each is taken for half of what is left.
void TellProgress(const DiagnoseOptions& options, const std::string& cause, std::size_t round,
                  std::size_t looked_at, std::size_t of) {
  if (!options.progress) return;
  const double left = std::exp2(1.0 - static_cast<double>(round));
  const double of_round = static_cast<double>(looked_at) / static_cast<double>(of);
  options.progress(
      round == 1 ? "looking for " + cause : fmt::format("round {}: looking for {}", round, cause),
      1.0 - left * (1.0 - 0.5 * of_round));
}

}  // namespace

Selection Select(const Judge& judge, std::span<const std::size_t> given, const DiagnoseOptions& options) {
  const auto& rules = judge.study().causes();
  Selection selection;
  selection.model = judge.Fit(given, nullptr);
  const ScoredModel first = selection.model;
  std::map<std::size_t, CandidateResult> judged;
  std::set<std::vector<std::size_t>> seen;
  bool circling = false;
  LazyCandidates lazy(judge, [&](std::size_t cause) {
    TellProgress(options, rules[cause].name, seen.size(), cause, rules.size());
  });
  bool reconsidered = false;  // what stands in a nuisance term's place
  while (true) {
    // What was found and dropped again would be found again: of a set that comes again only what passes
    // together is looked for.
    const bool known = !seen.insert(selection.model.fit.causes).second;
    if (known && circling) break;
    circling = known;
    const ScoredModel& model = selection.model;
    const double explained = judge.Compare(model, first).likelihood_ratio;
    const double error = ErrorAllowed(model, given.size(), options);
    const bool full = model.fit.causes.size() >= given.size() + options.max_effects;
    // In a round that goes in circles they are asked for beside a nuisance term alone.
    std::vector<Candidate> candidates;
    const Candidate* chosen = nullptr;
    const auto choose = [&] {
      Rank(judge.study(), candidates);
      if (!circling) chosen = ChooseNext(judge, given, model, candidates, explained, full, error, judged);
    };
    if (!circling || HasNuisanceTerm(judge, model)) {
      candidates = lazy.Strongest(model);
      choose();
      if (lazy.AddOthers(model, chosen, candidates)) choose();
    }
    if (chosen != nullptr && FindDeeper(judge, chosen->model, selection.model)) {
      seen.erase(selection.model.fit.causes);
      continue;
    }
    double brought = 0.0;
    if (chosen != nullptr) {
      brought = chosen->against.likelihood_ratio;
      selection.dominated[chosen->cause] = Dominated(judge.study(), candidates, *chosen, model);
      selection.model = ScoredModel(chosen->model);
    } else {
      const std::size_t most = given.size() + options.max_effects - model.fit.causes.size();
      const auto find_pair = [&] {
        return FindPair(judge, given, model, candidates, error, selection.dominated, selection.pair_rivals);
      };
      std::optional<ScoredModel> together;
      if (!reconsidered && ForgetWhatIsBehindNuisanceTerms(judge, given, selection)) {
        reconsidered = true;
        if (Exchange(judge, given, options, selection.dominated, selection.model, explained)) continue;
      }
      if (!full && circling) together = find_pair();
      if (!full && !together) together = FindTogether(judge, given, model, most, error);
      if (!full && !together && !circling) together = find_pair();
      if (!together) break;
      brought = judge.Compare(*together, model).likelihood_ratio;
      selection.model = std::move(*together);
    }
    for (int round = 0; round < 3; ++round) {
      const bool exchanged =
          selection.model.fit.causes.size() > given.size() + 1 &&
          Exchange(judge, given, options, selection.dominated, selection.model, explained + brought);
      const bool dropped = DropNeedless(judge, given, options, selection.model);
      if (!exchanged && !dropped) break;
    }
  }
  for (auto& [cause, result] : judged) selection.candidates.push_back(std::move(result));
  return selection;
}

std::vector<std::string> RivalsOf(const Judge& judge, const ScoredModel& model, const DominatedBy& dominated,
                                  std::size_t cause) {
  const auto& rules = judge.study().causes();
  if (!rules[cause].named) return {};
  std::vector<std::string> rivals = rules[cause].aliases;
  const ScoredModel without = judge.Fit(Without(model.fit.causes, cause), &model.fit);
  if (!without.fit.usable) return rivals;
  const Comparison own = judge.Compare(model, without);
  for (std::size_t other = 0; other < rules.size(); ++other) {
    if (!rules[other].named || Contains(model.fit.causes, other)) continue;
    if (IsDominated(dominated, cause, other)) continue;
    ScoredModel exchanged = judge.Fit(With(without.fit.causes, other), &without.fit);
    if (!exchanged.fit.usable) continue;
    // As probable; or explaining the same at the price of more numbers: simpler is likelier, but no proof.
    const Comparison its = judge.Compare(exchanged, without);
    const bool as_good = judge.Score(its, rules[other]) >= judge.Score(own, rules[cause]) - kAsGood ||
                         its.likelihood_ratio >= own.likelihood_ratio - kWithinThreeSigma;
    if (!as_good) continue;
    exchanged = judge.Fit(exchanged.fit.causes, &exchanged.fit, FitPurpose::kJudge);
    if (!judge.Objection(exchanged.fit, other, kNotExcluded).empty()) continue;
    // One cause in two forms (a drift by time, or by temperature): the form is what cannot be told.
    const bool same = rules[other].name == rules[cause].name && !rules[other].parameters.empty();
    std::string name =
        same ? rules[other].name + " as " + rules[other].parameters.front().name : rules[other].name;
    // One of several forms of a rival is enough.
    if (std::ranges::find(rivals, name) == rivals.end()) rivals.push_back(std::move(name));
  }
  return rivals;
}

}  // namespace strainwave::analysis::diagnosis
