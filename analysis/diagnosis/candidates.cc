// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/candidates.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <mutex>
#include <utility>

#include "analysis/diagnosis/cause_sets.h"
#include "analysis/diagnosis/model_uncertainty.h"
#include "analysis/diagnosis/refinement.h"

namespace strainwave::analysis::diagnosis {
namespace {

// Of BIC, or as much of a p-value that is corrected. The errors of one fit are too large next to another
// cause that can take its shape: where the likelihood is decisive, they are asked for less
// (Hauck & Donner, J. Am. Stat. Assoc. 72 (1977) 851).
constexpr double kDecisive = 20.0;

// Blocks over which an effect has to lie for what the others show of it to predict each.
constexpr double kBlocksToPredict = 4.0;
// Of the likelihood ratio, that an effect in fewer blocks may lose on held-out data: they were predicted
// three times as high as they are. What is predicted worse than that is a shape between the samples.
constexpr double kLossUnpredicted = 1.5;

// Over how many blocks as good as equal ones a cause changes what is predicted (the participation ratio of
// its energy). Of a bump of three samples without the two in its middle nobody knows the height.
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

}  // namespace

Candidate FitCandidate(const Judge& judge, const ScoredModel& model, std::size_t cause) {
  Candidate candidate{cause, judge.Fit(With(model.fit.causes, cause), &model.fit), {}, -1e300};
  if (!candidate.model.fit.usable) return candidate;
  candidate.against = judge.Compare(candidate.model, model);
  candidate.score = judge.Score(candidate.against, judge.study().causes()[cause]);
  return candidate;
}

std::vector<Candidate> FitCandidates(const Judge& judge, const ScoredModel& model,
                                     const std::function<bool(std::size_t)>& is_out,
                                     const std::function<void(std::size_t)>& begins) {
  const Study& study = judge.study();
  std::vector<std::size_t> causes;
  for (std::size_t cause = 0; cause < study.causes().size(); ++cause) {
    if (MayStandBeside(study, model.fit, cause) && !is_out(cause)) causes.push_back(cause);
  }
  std::vector<Candidate> candidates(causes.size());
  std::mutex telling;
  judge.parallel()(causes.size(), [&](std::size_t i) {
    {
      const std::lock_guard lock(telling);
      begins(causes[i]);
    }
    candidates[i] = FitCandidate(judge, model, causes[i]);
  });
  std::erase_if(candidates, [](const Candidate& candidate) { return !candidate.model.fit.usable; });
  return candidates;
}

void Rank(const Study& study, std::vector<Candidate>& candidates) {
  if (candidates.empty()) return;
  const auto describes = [&](const Candidate& candidate) {
    return IsNuisanceTerm(study.causes()[candidate.cause]);
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

std::set<std::size_t> Dominated(const Study& study, const std::vector<Candidate>& candidates,
                                const Candidate& chosen, const ScoredModel& poorer) {
  const double ahead = WhiteRatio(chosen.model, poorer);
  std::set<std::size_t> behind;
  if (ahead < kClearlyAhead) return behind;
  for (const Candidate& candidate : candidates) {
    if (WhiteRatio(candidate.model, poorer) < kNowhereNear * ahead) behind.insert(candidate.cause);
  }
  // A cause that fits nowhere is not among the candidates.
  for (std::size_t cause = 0; cause < study.causes().size(); ++cause) {
    if (study.causes()[cause].named && !Contains(poorer.fit.causes, cause) &&
        std::ranges::find(candidates, cause, &Candidate::cause) == candidates.end())
      behind.insert(cause);
  }
  return behind;
}

bool LooksPossible(const Judge& judge, const Candidate& candidate, double error) {
  const CauseRule& rule = judge.study().causes()[candidate.cause];
  return IsBeyondChance(candidate.against, rule, judge.Corrected(candidate.against.p_value, rule), error);
}

CandidateResult JudgeCause(const Judge& judge, const ScoredModel& with, const ScoredModel& without,
                           std::size_t cause, double error_allowed) {
  const CauseRule& rule = judge.study().causes()[cause];
  const Comparison comparison = judge.Compare(with, without);
  CandidateResult result{
      cause, {DeltaBic(comparison, rule), judge.Corrected(comparison.p_value, rule), 0.0}, false, {}};
  if (!IsBeyondChance(comparison, rule, result.evidence.p_value, error_allowed)) {
    result.objection = "not beyond chance";
    return result;
  }
  // What both have in common as well: in a long block a local effect lies whole, and neither model could
  // predict it there.
  const bool local = std::ranges::any_of(
      with.fit.causes, [&](std::size_t other) { return judge.study().causes()[other].local; });
  result.evidence.heldout_gain = judge.HeldOutGain(with.fit, without.fit, with.noise, local);
  const bool decisive =
      result.evidence.delta_bic > kDecisive || result.evidence.p_value < std::exp(-0.5 * kDecisive);
  // A block that alone has the highest speeds is nothing that the others could predict.
  if (!local && (judge.HasFewBlocks() || decisive) && !(result.evidence.heldout_gain > 0.0))
    result.evidence.heldout_gain = judge.HeldOutGain(with.fit, without.fit, with.noise, true);
  const ScoredModel reported = judge.Fit(with.fit.causes, &with.fit, FitPurpose::kJudge);
  result.objection =
      decisive ? judge.Objection(reported.fit, cause, kNotExcluded) : judge.Objection(reported.fit, cause);
  const bool predicted = result.evidence.heldout_gain > 0.0 ||
                         (rule.of_few_samples &&
                          result.evidence.heldout_gain > -kLossUnpredicted * comparison.likelihood_ratio &&
                          BlocksCovered(judge, with.fit, without.fit) < kBlocksToPredict);
  if (result.objection.empty() && !predicted) {
    result.objection = "does not predict held-out data better";
  }
  if (result.objection.empty() && IsUncertain(judge, with, without, cause, error_allowed)) {
    result.objection =
        "shown by a few moments alone, in which the model may be wrong by chance (a reversal, a knock)";
  }
  result.passed = result.objection.empty();
  return result;
}

}  // namespace strainwave::analysis::diagnosis
