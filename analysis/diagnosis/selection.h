// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "analysis/diagnosis/diagnose.h"
#include "analysis/diagnosis/heldout.h"
#include "analysis/diagnosis/noise_likelihood.h"
#include "analysis/diagnosis/recent.h"

namespace strainwave::analysis::diagnosis {

/// A fitted set of causes with the noise that it leaves.
struct ScoredModel {
  ModelFit fit;
  NoiseFit noise;
};

/// What one model is ahead of another one by.
struct Comparison {
  double likelihood_ratio{};      // 2 Δ log-likelihood, never below 0
  double delta_bic{};             // each number charged by all samples
  double samples{};               // with weight
  double log_search_locations{};  // of the search locations, over those that the richer model's rules count
  double p_value{1.0};            // of so many trials more, not yet corrected by the rule's
  double more_parameters{};       // as they are charged for
  double more_location_parameters{};  // of these, those that `log_search_locations` charges for
};

/// Whether what the richer model has more is no play of chance: by the p-value, corrected for all that was
/// looked at, with BIC as a bound; a cause has to bring more than none.
bool IsBeyondChance(const Comparison& comparison, const CauseRule& rule, double corrected_p_value,
                    double error);

/// BIC that a cause brings. Its numbers are charged by the samples, ln n each (a standard error of 1/√n of
/// the prior's width); of those that are known as sharply as the effect is large, by that, ln of the
/// likelihood ratio: Laplace's approximation for phases, locations and shares of one amplitude (Kass &
/// Raftery, J. Am. Stat. Assoc. 90 (1995) 773, section 4).
double DeltaBic(const Comparison& comparison, const CauseRule& rule);

/// BIC that a cause has to bring beside another one: none at all, unless its rule asks for less.
double LeastBicBeside(const CauseRule& rule);

/// Fits and compares sets of causes of one study under one set of weights.
class Judge {
 public:
  Judge(const Study& study, std::vector<double> weights, const DiagnoseOptions& options);

  const Study& study() const { return study_; }
  std::span<const double> weights() const { return weights_; }
  double samples() const { return samples_; }

  ScoredModel Fit(std::span<const std::size_t> causes, const ModelFit* start,
                  FitPurpose purpose = FitPurpose::kCompare) const;
  Comparison Compare(const ScoredModel& richer, const ScoredModel& poorer) const;

  /// BIC of a cause that brings this likelihood ratio at the cost of so many parameters, less what the
  /// locations searched cost: by how many there are, and by how sharply each is known (Laplace's
  /// approximation, in which an amount is known to 1/√samples and a location to 1/√ratio of a resolution
  /// cell).
  double Score(const Comparison& comparison, const CauseRule& rule) const;

  /// p-value of one trial, times the locations that the cause's search covers and the candidates there are of
  /// its sort (causes, or nuisance terms), over the share of the error allowed that is for this sort.
  double Corrected(double p_value, const CauseRule& rule) const;

  /// Log-likelihood of held-out blocks that `richer` gains over `poorer`, in nats, with their autocorrelation
  /// taken off. Blocks are short where `local` is set.
  double HeldOutGain(const ModelFit& richer, const ModelFit& poorer, const NoiseFit& noise, bool local) const;

  /// Tasks that fit, each for itself.
  const ParallelFor& parallel() const { return parallel_; }

  const Folds& folds(bool local) const { return local ? short_folds_ : folds_; }

  /// Whether a number may be shown by one block alone (a slip by the one peak that is beyond its level, the
  /// beginning of a drift): without it the others can but extrapolate. Short blocks tell more there.
  bool HasFewBlocks() const { return folds_.blocks < kFewBlocks; }

  /// Residuals of samples that the fit has not seen.
  std::vector<double> HeldOut(const ModelFit& fit, bool local) const;

  /// Why this cause's parameters are not believed; empty if they are. The fit is to be one for reporting.
  /// `away_from_zero`: standard errors that an amount has to be.
  std::string Objection(const ModelFit& fit, std::size_t cause, double away_from_zero = 3.0) const;

 private:
  static constexpr std::size_t kFewBlocks = 30;

  const Study& study_;
  std::vector<double> weights_;
  double samples_{};
  double scale_{};
  Folds folds_;
  Folds short_folds_;
  ParallelFor parallel_;

  /// What a fit depends on beside the weights. Judging of candidates, of exchanges and of what was chosen in
  /// the end ask for the same one several times.
  struct FitRequest {
    std::vector<std::size_t> causes;
    std::vector<std::size_t> start_causes;
    std::vector<double> start_state;
    FitPurpose purpose{};
    bool operator==(const FitRequest&) const = default;
  };
  struct HeldOutRequest {
    std::vector<std::size_t> causes;
    std::vector<double> state;
    bool local{};
    bool operator==(const HeldOutRequest&) const = default;
  };
  mutable Recent<FitRequest, ScoredModel> fits_;
  mutable Recent<HeldOutRequest, std::vector<double>> held_out_;
};

/// Two causes that do as well together as one cause of a model ("brake_slip + thermal_drift"), by its index.
using PairRivals = std::map<std::size_t, std::vector<std::string>>;

/// By a cause that was chosen: those that explained so much less than it that nothing found since makes them
/// do in its place.
using DominatedBy = std::map<std::size_t, std::set<std::size_t>>;

/// Forward selection with backward check and exchange, from the causes in `start` (which stay).
struct Selection {
  ScoredModel model;
  std::vector<CandidateResult> candidates;  // those that are not in the model, as judged beside it
  PairRivals pair_rivals;
  DominatedBy dominated;
};
Selection Select(const Judge& judge, std::span<const std::size_t> given, const DiagnoseOptions& options);

/// Evidence of one cause of a model against the model without it.
CandidateResult JudgeCause(const Judge& judge, const ScoredModel& with, const ScoredModel& without,
                           std::size_t cause, double error_allowed);

/// Names of causes that would fit as well (within 6 of BIC) in the place of `cause`.
std::vector<std::string> RivalsOf(const Judge& judge, const ScoredModel& model, const DominatedBy& dominated,
                                  std::size_t cause);

}  // namespace strainwave::analysis::diagnosis
