// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/selection.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <set>
#include <utility>

#include "analysis/diagnosis/cause_sets.h"
#include "analysis/diagnosis/refinement.h"

namespace strainwave::analysis::diagnosis {
namespace {

constexpr double kAsGood = 6.0;        // of BIC: odds of 20 to 1
constexpr double kPairAhead = 8.0;     // of two causes, to take the place of one
constexpr double kErrorBeside = 0.15;  // of the error allowed, for what comes on top of something found
// Standard errors from zero: a rival need not be proven, only not be excluded.
constexpr double kNotExcluded = 2.0;
// Of BIC, or as much of a p-value that is corrected. The errors of one fit are too large next to another
// cause that can take its shape: where the likelihood leaves no doubt, they are asked for less (Hauck &
// Donner, J. Am. Stat. Assoc. 72 (1977) 851).
constexpr double kNoDoubt = 20.0;
constexpr double kWithinThreeSigma = 9.0;  // of the likelihood ratio, between two causes
// A further effect has to bring this share of what all have brought: less may be the misfit of a formula.
constexpr double kLeastShare = 0.004;              // of the likelihood ratio
constexpr double kLeastShareOfDescription = 0.01;  // of a further one

// Share of the likelihood ratio of a cause below which another one is no rival.
constexpr double kNowhereNear = 0.2;
// Blocks over which an effect has to lie for what the others show of it to foretell each.
constexpr double kBlocksToForetell = 4.0;
// Of the likelihood ratio, that an effect in fewer blocks may lose on held-out data: they were foretold three
// times as high as they are. What is foretold worse than that is a shape between the samples.
constexpr double kLossUnforetold = 1.5;

struct Candidate {
  std::size_t cause{};
  ScoredModel model;
  Comparison against;
  double score{};  // BIC less what the places searched cost
};

// Over how many blocks as good as equal ones a cause changes what is foretold (the participation ratio of its
// energy). Of a bump of three samples without the two in its middle nobody knows the height.
double BlocksCovered(const Judge& judge, const ModelFit& with, const ModelFit& without) {
  const Folds& folds = judge.folds(true);
  std::vector<double> energy(folds.blocks, 0.0);
  for (std::size_t i = 0; i < folds.block_of.size(); ++i) {
    const auto sample = static_cast<Eigen::Index>(i);
    const double change = with.predicted(sample) - without.predicted(sample);
    energy[folds.block_of[i]] += judge.weights()[i] * change * change;
  }
  double sum = 0.0;
  double squares = 0.0;
  for (const double of_block : energy) {
    sum += of_block;
    squares += of_block * of_block;
  }
  return squares > 0.0 ? sum * sum / squares : 0.0;
}

// The strongest first; causes stand before a correction that does not lead them by enough, so that the next
// one has its turn where the first does not pass.
void Rank(const Study& study, std::vector<Candidate>& candidates) {
  if (candidates.empty()) return;
  const auto describes = [&](const Candidate& candidate) {
    return IsDescription(study.causes()[candidate.cause]);
  };
  const auto of_causes = [&](const Candidate& candidate) {
    return describes(candidate) ? -std::numeric_limits<double>::infinity() : candidate.score;
  };
  const double explained =
      std::ranges::max_element(candidates, {}, &Candidate::score)->against.likelihood_ratio;
  const Comparison cause = std::ranges::max_element(candidates, {}, of_causes)->against;
  const auto rank = [&](const Candidate& candidate) {
    if (!describes(candidate)) return candidate.score;
    return candidate.score - LeadAsked(explained, candidate.against, cause);
  };
  std::ranges::stable_sort(candidates, std::greater<>(), rank);
}

// All candidates beside a model, each fitted with it, but for those that `is_out` names.
template <typename Predicate>
std::vector<Candidate> FitCandidates(const Judge& judge, const ScoredModel& model, Predicate is_out) {
  std::vector<Candidate> candidates;
  for (std::size_t cause = 0; cause < judge.study().causes().size(); ++cause) {
    if (Contains(model.fit.causes, cause) || is_out(cause)) continue;
    Candidate candidate{cause, judge.Fit(With(model.fit.causes, cause), &model.fit), {}, -1e300};
    if (!candidate.model.fit.usable) continue;
    candidate.against = judge.Compare(candidate.model, model);
    candidate.score = judge.Score(candidate.against, judge.study().causes()[cause]);
    candidates.push_back(std::move(candidate));
  }
  return candidates;
}

std::vector<Candidate> FitCandidates(const Judge& judge, const ScoredModel& model) {
  return FitCandidates(judge, model, [](std::size_t) { return false; });
}

// What came nowhere near the chosen one will hardly do in its place later.
std::set<std::size_t> FarBehind(const std::vector<Candidate>& candidates, const Candidate& chosen,
                                const ScoredModel& poorer) {
  const double ahead = WhiteRatio(chosen.model, poorer);
  std::set<std::size_t> behind;
  if (ahead < kClearlyAhead) return behind;
  for (const Candidate& candidate : candidates) {
    if (WhiteRatio(candidate.model, poorer) < kNowhereNear * ahead) behind.insert(candidate.cause);
  }
  return behind;
}

// Share of clean records in which this may be found. What comes on top of something found has to be clearer:
// it may be the misfit of a formula that is not nature's.
double ErrorAllowed(const ScoredModel& model, std::size_t given, const DiagnoseOptions& options) {
  return model.fit.causes.size() > given ? kErrorBeside * options.family_error : options.family_error;
}

bool LooksPossible(const Judge& judge, const Candidate& candidate, double error) {
  const CauseRule& rule = judge.study().causes()[candidate.cause];
  return IsBeyondChance(candidate.against, rule, judge.Corrected(candidate.against.p_value, rule), error);
}

// Effects none of which shows while the others are still in the residual: slow ones pass together for the
// memory of the noise. The strongest candidate as if the noise were white, the strongest beside it, and so
// on; then what the memory of what is left explains as well is taken out again, weakest first.
std::optional<ScoredModel> FindTogether(const Judge& judge, const ScoredModel& model, std::size_t most,
                                        double error) {
  if (model.noise.order == 0) return std::nullopt;
  const auto& rules = judge.study().causes();
  const auto white = [&](const Candidate& candidate, const ScoredModel& poorer) {
    const CauseRule& rule = rules[candidate.cause];
    const double ahead = WhiteRatio(candidate.model, poorer);
    const int more = candidate.model.fit.free_parameters - poorer.fit.free_parameters;
    // Without a discount for places: noise with a memory has lines and windows anywhere.
    return ahead - 2.0 * std::log(std::max(1.0, rule.trials)) - more * std::log(judge.samples()) -
           (IsDescription(rule) ? LeadAsked(ahead) : 0.0);
  };
  constexpr std::size_t kMostTogether = 3;
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
        return !JudgeCause(judge, all, without.model, without.cause, error).passed;
      });
    }
    if (weakest == rest.end()) return all;
    all = std::move(weakest->model);
  }
  return std::nullopt;
}

// Two causes in the place of one that mimics them together: it explains more than either, so it was found
// first, and no exchange of one for one leads away from it. A pair that is clearly better takes its place;
// one that does as well is its rival.
// @param rivals  set to the pairs that do as well, by the cause whose place they would take
std::optional<ScoredModel> FindPair(const Judge& judge, std::span<const std::size_t> given,
                                    const ScoredModel& model, double error, const FarBehindOf& far_behind,
                                    PairRivals& rivals) {
  const auto& rules = judge.study().causes();
  rivals.clear();
  std::optional<ScoredModel> best;
  double most = 0.0;
  for (const std::size_t cause : model.fit.causes) {
    if (Contains(given, cause)) continue;
    const ScoredModel without = judge.Fit(Without(model.fit.causes, cause), &model.fit);
    if (!without.fit.usable) continue;
    const double own = ScoreOf(judge, model, without, cause);
    // A description has to be better than causes, not they than it.
    const double asked = rules[cause].named ? kPairAhead : 0.0;
    std::vector<Candidate> firsts = FitCandidates(judge, without, [&](std::size_t part) {
      return part == cause || !rules[part].named || IsFarBehind(far_behind, cause, part);
    });
    // What neither of two explains alone may pass for the noise's memory: a description holds both.
    if (!IsDescription(rules[cause]))
      std::erase_if(firsts, [&](const Candidate& part) { return !LooksPossible(judge, part, error); });
    constexpr std::size_t kMostParts = 3;
    std::ranges::sort(firsts, std::greater<>(),
                      [&](const Candidate& part) { return WhiteRatio(part.model, without); });
    if (firsts.size() > kMostParts) firsts.erase(firsts.begin() + kMostParts, firsts.end());
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
        if (lead - asked < most || !JudgeCause(judge, pair, first.model, second.cause, error).passed)
          continue;
        const ScoredModel other = judge.Fit(Without(pair.fit.causes, first.cause), &pair.fit);
        if (!JudgeCause(judge, pair, other, first.cause, error).passed) continue;
        most = lead - asked;
        best = std::move(pair);
      }
    }
    rivals[cause].assign(pairs.begin(), pairs.end());
  }
  return best;
}

}  // namespace

CandidateResult JudgeCause(const Judge& judge, const ScoredModel& with, const ScoredModel& without,
                           std::size_t cause, double error_allowed) {
  const CauseRule& rule = judge.study().causes()[cause];
  const Comparison comparison = judge.Compare(with, without);
  CandidateResult result{
      cause, {comparison.delta_bic, judge.Corrected(comparison.p_value, rule), 0.0}, false, {}};
  if (!IsBeyondChance(comparison, rule, result.evidence.p_value, error_allowed)) {
    result.objection = "not beyond chance";
    return result;
  }
  // What both have in common as well: in a long block a local effect lies whole, and neither model could
  // foretell it there.
  const bool local = std::ranges::any_of(
      with.fit.causes, [&](std::size_t other) { return judge.study().causes()[other].local; });
  result.evidence.heldout_gain = judge.HeldOutGain(with.fit, without.fit, with.noise, local);
  const bool no_doubt =
      comparison.delta_bic > kNoDoubt || result.evidence.p_value < std::exp(-0.5 * kNoDoubt);
  // A block that alone has the highest speeds is nothing that the others could foretell.
  if (!local && (judge.HasFewBlocks() || no_doubt) && !(result.evidence.heldout_gain > 0.0))
    result.evidence.heldout_gain = judge.HeldOutGain(with.fit, without.fit, with.noise, true);
  const ScoredModel reported = judge.Fit(with.fit.causes, &with.fit, FitPurpose::kJudge);
  result.objection =
      no_doubt ? judge.Objection(reported.fit, cause, kNotExcluded) : judge.Objection(reported.fit, cause);
  const bool foretold =
      result.evidence.heldout_gain > 0.0 ||
      (rule.of_few_samples && result.evidence.heldout_gain > -kLossUnforetold * comparison.likelihood_ratio &&
       BlocksCovered(judge, with.fit, without.fit) < kBlocksToForetell);
  if (result.objection.empty() && !foretold) {
    result.objection = "does not predict held-out data better";
  }
  result.passed = result.objection.empty();
  return result;
}

Selection Select(const Judge& judge, std::span<const std::size_t> given, const DiagnoseOptions& options) {
  Selection selection;
  selection.model = judge.Fit(given, nullptr);
  const ScoredModel first = selection.model;
  std::map<std::size_t, CandidateResult> judged;
  std::set<std::vector<std::size_t>> seen;
  bool circling = false;
  while (true) {
    // What was found and dropped again would be found again: of a set that comes again only what passes
    // together is looked for.
    const bool known = !seen.insert(selection.model.fit.causes).second;
    if (known && circling) break;
    circling = known;
    const ScoredModel& model = selection.model;
    const double explained = judge.Compare(model, first).likelihood_ratio;
    std::vector<Candidate> candidates;
    if (!circling) {
      candidates = FitCandidates(judge, model);
      Rank(judge.study(), candidates);
      judged.clear();
    }
    const Candidate* chosen = nullptr;
    const double error = ErrorAllowed(model, given.size(), options);
    const bool lacks = std::ranges::any_of(model.fit.causes, [&](std::size_t cause) {
      return !judge.study().causes()[cause].named && !Contains(given, cause);
    });
    const bool full = model.fit.causes.size() >= given.size() + options.max_effects;
    for (const Candidate& candidate : candidates) {
      const CauseRule& rule = judge.study().causes()[candidate.cause];
      CandidateResult result{
          candidate.cause,
          {candidate.against.delta_bic, judge.Corrected(candidate.against.p_value, rule), 0.0},
          false,
          "not beyond chance"};
      if (chosen == nullptr && !full && LooksPossible(judge, candidate, error)) {
        result = JudgeCause(judge, candidate.model, model, candidate.cause, error);
        const bool beside = model.fit.causes.size() > given.size();
        if (result.passed &&
            ((beside && candidate.against.delta_bic < LeastBicBeside(candidate.against, rule)) ||
             candidate.against.likelihood_ratio <
                 (lacks && !rule.named ? kLeastShareOfDescription : kLeastShare) * explained ||
             IsMisfit(judge, given, candidate.model, model, candidate.cause))) {
          result.passed = false;
          result.objection =
              "too small beside what was found already to be told from a misfit of its formula";
        }
        if (result.passed) chosen = &candidate;
      } else if (LooksPossible(judge, candidate, error)) {
        result.objection = "another candidate explains more";
      }
      judged[candidate.cause] = std::move(result);
    }
    if (options.progress) {
      options.progress(
          chosen == nullptr ? "no further effect" : "found " + judge.study().causes()[chosen->cause].name,
          static_cast<double>(seen.size()) / static_cast<double>(options.max_effects + 1));
    }
    if (chosen != nullptr && FindDeeper(judge, chosen->model, selection.model)) {
      seen.erase(selection.model.fit.causes);
      continue;
    }
    double brought = 0.0;
    if (chosen != nullptr) {
      brought = chosen->against.likelihood_ratio;
      selection.far_behind[chosen->cause] = FarBehind(candidates, *chosen, model);
      selection.model = ScoredModel(chosen->model);
    } else {
      const std::size_t most = given.size() + options.max_effects - model.fit.causes.size();
      const auto find_pair = [&] {
        return FindPair(judge, given, model, error, selection.far_behind, selection.pair_rivals);
      };
      std::optional<ScoredModel> together;
      if (!full && circling) together = find_pair();
      if (!full && !together) together = FindTogether(judge, model, most, error);
      if (!full && !together && !circling) together = find_pair();
      if (!together) break;
      brought = judge.Compare(*together, model).likelihood_ratio;
      selection.model = std::move(*together);
    }
    for (int round = 0; round < 3; ++round) {
      const bool exchanged =
          selection.model.fit.causes.size() > given.size() + 1 &&
          Exchange(judge, given, options, selection.far_behind, selection.model, explained + brought);
      const bool dropped = DropNeedless(judge, given, options, selection.model);
      if (!exchanged && !dropped) break;
    }
  }
  for (auto& [cause, result] : judged) selection.candidates.push_back(std::move(result));
  return selection;
}

std::vector<std::string> RivalsOf(const Judge& judge, const ScoredModel& model, const FarBehindOf& far_behind,
                                  std::size_t cause) {
  const auto& rules = judge.study().causes();
  if (!rules[cause].named) return {};
  std::vector<std::string> rivals = rules[cause].aliases;
  const ScoredModel without = judge.Fit(Without(model.fit.causes, cause), &model.fit);
  if (!without.fit.usable) return rivals;
  const Comparison own = judge.Compare(model, without);
  for (std::size_t other = 0; other < rules.size(); ++other) {
    if (!rules[other].named || Contains(model.fit.causes, other)) continue;
    if (IsFarBehind(far_behind, cause, other)) continue;
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
