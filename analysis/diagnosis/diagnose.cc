// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/diagnose.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "analysis/diagnosis/cause_sets.h"
#include "analysis/diagnosis/heldout.h"
#include "analysis/diagnosis/outliers.h"
#include "analysis/diagnosis/refinement.h"
#include "analysis/diagnosis/residual_tests.h"
#include "analysis/diagnosis/residuals.h"
#include "analysis/diagnosis/selection.h"
#include "analysis/noise_level.h"

namespace strainwave::analysis::diagnosis {
namespace {

// Of the time that a diagnosis takes, about: until what was found is judged, and until what is left is told.
constexpr double kShareOfSearch = 0.8;
constexpr double kShareOfJudging = 0.9;

double SquareSum(const Study& study, const ModelFit& fit, std::span<const double> weights) {
  const std::vector<double> residuals = ResidualsOf(study, fit);
  double sum = 0.0;
  for (std::size_t i = 0; i < residuals.size(); ++i) sum += weights[i] * residuals[i] * residuals[i];
  return sum;
}

bool IsGiven(const DiagnoseOptions& options, std::size_t cause) {
  return std::ranges::find(options.given_causes, cause) != options.given_causes.end();
}

// A cause that was found, beside the model without it.
struct Found {
  std::size_t cause{};
  ScoredModel without;
  CandidateResult judged;
  NullEvidence simulated{};
};

std::vector<Found> JudgeAll(const Judge& judge, const ScoredModel& model, const DiagnoseOptions& options) {
  std::vector<Found> all;
  for (const std::size_t cause : model.fit.causes) {
    if (IsGiven(options, cause)) continue;
    Found found{cause, judge.Fit(Without(model.fit.causes, cause), &model.fit, FitPurpose::kJudge), {}};
    found.judged = JudgeCause(judge, model, found.without, cause, options.family_error);
    all.push_back(std::move(found));
  }
  return all;
}

// A nuisance term that costs more than it brings, where its p-value does not say all, or that takes nothing
// away, helps to find causes and says nothing of its own.
bool IsWorthTelling(const Judge& judge, const ScoredModel& model, const Found& found) {
  const CauseRule& rule = judge.study().causes()[found.cause];
  if (!IsNuisanceTerm(rule)) return true;
  return found.judged.evidence.delta_bic > LeastBicBeside(rule) &&
         SquareSum(judge.study(), found.without.fit, judge.weights()) >
             SquareSum(judge.study(), model.fit, judge.weights());
}

// What is found beside something else, has no cause, or predicts worse what was held out, and whose evidence
// is gone once everything is fitted to the end, is none: the weakest first.
// @param candidates  gets what was dropped
std::vector<Found> DropUnproven(const Judge& judge, ScoredModel& model, const DiagnoseOptions& options,
                                std::vector<CandidateResult>& candidates) {
  for (;;) {
    std::vector<Found> all = JudgeAll(judge, model, options);
    for (Found& found : all) {
      if (!found.judged.passed || IsWorthTelling(judge, model, found)) continue;
      found.judged.passed = false;
      found.judged.objection = "costs more than it brings";
    }
    const auto is_unproven = [&](const Found& found) {
      const bool may_go = all.size() > 1 || !judge.study().causes()[found.cause].named ||
                          !(found.judged.evidence.heldout_gain > 0.0) ||
                          !(found.judged.evidence.delta_bic > 0.0);
      return may_go && !found.judged.passed && found.without.fit.usable &&
             IsWithinRanges(judge, options.given_causes, found.without.fit);
    };
    Found* weakest = nullptr;
    for (Found& found : all) {
      const auto evidence = [](const Found& other) { return other.judged.evidence.delta_bic; };
      if (is_unproven(found) && (weakest == nullptr || evidence(found) < evidence(*weakest)))
        weakest = &found;
    }
    if (weakest == nullptr) return all;
    candidates.push_back(std::move(weakest->judged));
    model = std::move(weakest->without);
  }
}

// What the same search names in a record that was simulated without any cause.
std::vector<NamedClaim> ClaimsOf(const Study& study, DiagnoseOptions options) {
  options.simulate = nullptr;
  options.progress = nullptr;
  options.parallel = InTurn;
  std::vector<NamedClaim> claims;
  for (const Finding& finding : Diagnose(study, options).causes)
    claims.push_back({study.causes()[finding.index].name, finding.evidence.delta_bic});
  return claims;
}

// Drops the named causes that records without them show, too; the others keep what such records show of them.
// @param candidates  gets what was dropped
std::vector<Found> DropSimulated(const Judge& judge, ScoredModel& model, const DiagnoseOptions& options,
                                 std::vector<Found> all, std::vector<CandidateResult>& candidates) {
  std::vector<NamedClaim> claims;
  std::vector<std::size_t> claiming;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const CauseRule& rule = judge.study().causes()[all[i].cause];
    if (!rule.named) continue;
    claims.push_back({rule.name, all[i].judged.evidence.delta_bic});
    claiming.push_back(i);
  }
  if (claims.empty()) return all;
  const std::vector<NullEvidence> evidence = JudgeBySimulation(
      claims, model.fit.nominal, options.simulate,
      [&](const Study& study) { return ClaimsOf(study, options); }, options.seed, options.parallel);
  std::vector<std::size_t> causes = model.fit.causes;
  for (std::size_t i = 0; i < claims.size(); ++i) {
    Found& found = all[claiming[i]];
    found.simulated = evidence[i];
    if (!IsRefused(evidence[i])) continue;
    causes = Without(causes, found.cause);
    found.judged.passed = false;
    found.judged.objection = fmt::format("{} of {} records simulated without it show as much",
                                         evidence[i].as_strong, evidence[i].simulated);
    candidates.push_back(found.judged);
  }
  if (causes.size() == model.fit.causes.size()) return all;
  model = judge.Fit(causes, &model.fit, FitPurpose::kJudge);
  std::vector<Found> left = DropUnproven(judge, model, options, candidates);
  for (Found& found : left) {
    const auto before = std::ranges::find(all, found.cause, &Found::cause);
    if (before != all.end()) found.simulated = before->simulated;
  }
  return left;
}

// Where no more is left of a response that stands on steps, or whose drive does, than the steps do: it
// follows them, and so time, rests and all that turns with the response, without a course of its own. Beside
// the standard deviation of rounding there may be noise of 0.3 steps, √(1 + 12 · 0.3²) of it in all: more
// leaves less than a sixth of the steps' course, exp(−2π² · 0.3²) of its first harmonic.
constexpr double kLeftOfRounding = 1.44;

bool IsRounding(const Study& study, const ModelFit& fit, std::span<const double> weights) {
  double samples = 0.0;
  for (const double weight : weights) samples += weight;
  return study.Rounding() > 0.0 &&
         SquareSum(study, fit, weights) <= samples * std::pow(kLeftOfRounding * study.Rounding(), 2);
}

Finding Report(const Judge& judge, const ScoredModel& model, const Found& found, double explainable,
               const DominatedBy& dominated) {
  const auto place =
      static_cast<std::size_t>(std::ranges::find(model.fit.causes, found.cause) - model.fit.causes.begin());
  Finding finding{found.cause,    model.fit.cause_parameters[place], found.judged.evidence, 0.0, {},
                  found.simulated};
  const double lost = SquareSum(judge.study(), found.without.fit, judge.weights()) -
                      SquareSum(judge.study(), model.fit, judge.weights());
  finding.share_of_explainable = explainable > 0.0 ? std::clamp(lost / explainable, 0.0, 1.0) : 0.0;
  finding.indistinguishable_from = RivalsOf(judge, model, dominated, found.cause);
  return finding;
}

void ReportNames(const Study& study, std::span<const Found> all_found, Diagnosis& diagnosis) {
  for (const Found& one : all_found) {
    diagnosis.candidates.push_back({one.cause, one.judged.evidence, true, {}});
    const bool named = study.causes()[one.cause].named;
    (named ? diagnosis.causes : diagnosis.nuisance_terms)
        .push_back({one.cause, {}, one.judged.evidence, 0.0, {}, one.simulated});
  }
}

bool IsCurve(const Finding& nuisance_term) {
  return std::ranges::any_of(nuisance_term.parameters,
                             [](const ParameterValue& value) { return value.name.starts_with(kCurvePart); });
}

// What the residual shows in words, of the model with these causes of `fit`.
std::string WordsOf(const Judge& judge, const ModelFit& fit, std::span<const Finding> left_out) {
  std::vector<std::size_t> causes = fit.causes;
  for (const Finding& finding : left_out) causes = Without(causes, finding.index);
  const std::vector<double> left =
      ResidualsOf(judge.study(), causes == fit.causes ? fit : judge.Fit(causes, &fit).fit);
  return DescribeResidual(
      judge.study(), Eigen::Map<const Eigen::VectorXd>(left.data(), static_cast<Eigen::Index>(left.size())),
      judge.weights(), judge.parallel());
}

// The extended model without what has no name, held out.
std::vector<double> HeldOutAsSimulated(const Judge& judge, const ModelFit& extended, bool local) {
  std::vector<std::size_t> simulated = extended.causes;
  std::erase_if(simulated, [&](std::size_t cause) { return IsNuisanceTerm(judge.study().causes()[cause]); });
  return judge.HeldOut(simulated == extended.causes ? extended : judge.Fit(simulated, &extended).fit, local);
}

}  // namespace

Diagnosis Diagnose(const Study& study, const DiagnoseOptions& options) {
  Diagnosis diagnosis;
  diagnosis.weights.assign(study.Weights().begin(), study.Weights().end());
  if (diagnosis.weights.empty()) diagnosis.weights.assign(study.measured().size(), 1.0);
  for (int round = 0; round < 2; ++round) {
    const ModelFit fit = study.Fit(options.given_causes, diagnosis.weights, nullptr, FitPurpose::kCompare);
    if (!LeaveOutSpikes(study, fit, diagnosis.weights)) break;
  }
  DiagnoseOptions searching = options;
  if (options.progress) {
    searching.progress = [&options](const std::string& step, double share) {
      options.progress(step, kShareOfSearch * share);
    };
  }
  auto judge = std::make_unique<Judge>(study, diagnosis.weights, options);
  Selection selection = Select(*judge, options.given_causes, searching);
  // What looked like noise beside a missing effect may stand out now.
  if (LeaveOutSpikes(study, selection.model.fit, diagnosis.weights)) {
    judge = std::make_unique<Judge>(study, diagnosis.weights, options);
    selection = Select(*judge, options.given_causes, searching);
  }
  if (options.progress) options.progress("judging what was found", kShareOfSearch);
  const FitPurpose of_nominal = options.names_only ? FitPurpose::kJudge : FitPurpose::kReport;
  const ScoredModel nominal = judge->Fit(options.given_causes, nullptr, of_nominal);
  ScoredModel extended = judge->Fit(selection.model.fit.causes, &selection.model.fit, FitPurpose::kJudge);
  diagnosis.candidates = std::move(selection.candidates);
  std::vector<Found> all_found = DropUnproven(*judge, extended, options, diagnosis.candidates);
  if (!all_found.empty() && IsRounding(study, nominal.fit, diagnosis.weights)) {
    for (Found& one : all_found) {
      one.judged.passed = false;
      one.judged.objection = "no more than the steps of the record do";
      diagnosis.candidates.push_back(std::move(one.judged));
    }
    all_found.clear();
    extended = nominal;
    diagnosis.notes.push_back(
        fmt::format("the record stands on steps of {:.3g} {}: what is left is no more than they do, and no "
                    "verdict on it",
                    std::sqrt(12.0) * study.Rounding() * study.unit_per_si(), study.unit()));
  }
  if (options.simulate) {
    all_found = DropSimulated(*judge, extended, options, std::move(all_found), diagnosis.candidates);
    if (std::ranges::any_of(all_found, [&](const Found& found) {
          return study.causes()[found.cause].named && found.simulated.simulated == 0;
        })) {
      diagnosis.notes.emplace_back(
          "the records cannot be simulated without what was found: it is not judged by simulation");
    }
  }
  if (options.names_only) {
    ReportNames(study, all_found, diagnosis);
    return diagnosis;
  }
  extended = judge->Fit(extended.fit.causes, &extended.fit, FitPurpose::kReport);
  diagnosis.nominal = nominal.fit;
  diagnosis.extended = extended.fit;
  diagnosis.open = nominal.fit.open;
  for (const std::string& words : extended.fit.open)
    if (std::ranges::find(diagnosis.open, words) == diagnosis.open.end()) diagnosis.open.push_back(words);
  const double filtered_out = study.FilteredOutVariance();
  const auto of_record = [&](double rmse) { return std::sqrt(rmse * rmse + filtered_out); };
  diagnosis.noise_floor = study.NoiseFloor() > 0.0 ? of_record(study.NoiseFloor()) : 0.0;

  const double missed = SquareSum(study, nominal.fit, diagnosis.weights);
  // What is explained could be, also where the noise was taken for more than it is.
  const double explainable = std::max(missed - judge->samples() * study.NoiseFloor() * study.NoiseFloor(),
                                      missed - SquareSum(study, extended.fit, diagnosis.weights));
  bool local = false;
  for (const Found& one : all_found) {
    Finding finding = Report(*judge, extended, one, explainable, selection.dominated);
    const std::vector<std::string>& pairs = selection.pair_rivals[one.cause];
    finding.indistinguishable_from.insert(finding.indistinguishable_from.end(), pairs.begin(), pairs.end());
    const CauseRule& rule = study.causes()[one.cause];
    local = local || rule.local;
    diagnosis.candidates.push_back({one.cause, finding.evidence, true, {}});
    (rule.named ? diagnosis.causes : diagnosis.nuisance_terms).push_back(std::move(finding));
  }
  const auto by_evidence = [](const auto& a, const auto& b) {
    return a.evidence.delta_bic > b.evidence.delta_bic;
  };
  std::sort(diagnosis.causes.begin(), diagnosis.causes.end(), by_evidence);
  std::sort(diagnosis.nuisance_terms.begin(), diagnosis.nuisance_terms.end(), by_evidence);
  std::sort(diagnosis.candidates.begin(), diagnosis.candidates.end(), by_evidence);

  const Folds& folds = judge->folds(local);
  const std::vector<double>& before = judge->HeldOut(nominal.fit, local);
  const bool found = !diagnosis.causes.empty() || !diagnosis.nuisance_terms.empty();
  const std::vector<double>& after = found ? judge->HeldOut(extended.fit, local) : before;
  diagnosis.nominal_heldout_rmse = of_record(HeldOutRmse(before, diagnosis.weights));
  diagnosis.extended_heldout_rmse = of_record(HeldOutRmse(after, diagnosis.weights));
  if (found)
    diagnosis.gain = EstimateGain(before, after, diagnosis.weights, folds, filtered_out, options.seed);

  const bool described = std::ranges::any_of(diagnosis.nuisance_terms, [&](const Finding& nuisance_term) {
    return IsNuisanceTerm(study.causes()[nuisance_term.index]);
  });
  diagnosis.verdict = !diagnosis.causes.empty() ? Verdict::kEffectFound
                      : described               ? Verdict::kUnnamedStructure
                                                : Verdict::kNoEffect;
  const std::vector<double> left = ResidualsOf(study, extended.fit);
  const std::vector<double> as_simulated = HeldOutAsSimulated(*judge, extended.fit, local);
  diagnosis.trusted = FindTrustedRegions(study, diagnosis.weights, left, {before, as_simulated});
  const double nominal_variance = diagnosis.nominal_heldout_rmse * diagnosis.nominal_heldout_rmse;
  const double extended_variance = diagnosis.extended_heldout_rmse * diagnosis.extended_heldout_rmse;
  if (nominal_variance > 0.0) {
    diagnosis.residual.share_of_residual_variance = std::clamp(
        (extended_variance - diagnosis.noise_floor * diagnosis.noise_floor) / nominal_variance, 0.0, 1.0);
  }
  diagnosis.residual.ljung_box_p = LjungBoxP(left, diagnosis.weights, study.segments(), 0);
  diagnosis.residual.runs_p = RunsP(left, diagnosis.weights, study.segments());
  if (options.progress) options.progress("describing what is left", kShareOfJudging);
  diagnosis.residual.signature = WordsOf(*judge, extended.fit, {});
  if (std::ranges::any_of(diagnosis.nuisance_terms, IsCurve))
    diagnosis.residual.described = WordsOf(*judge, extended.fit, diagnosis.nuisance_terms);
  const auto outliers = std::count(diagnosis.weights.begin(), diagnosis.weights.end(), 0.0);
  if (outliers > 0)
    diagnosis.notes.push_back(
        fmt::format("{} samples stand off their neighbours and were left out", outliers));
  return diagnosis;
}

}  // namespace strainwave::analysis::diagnosis
