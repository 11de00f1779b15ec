// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "analysis/diagnosis/simulated_null.h"
#include "analysis/diagnosis/study.h"
#include "analysis/diagnosis/trusted_regions.h"
#include "analysis/parallel_for.h"

namespace strainwave::analysis::diagnosis {

enum class Verdict { kEffectFound, kNoEffect, kUnnamedStructure };

/// What speaks for a candidate at the step at which it was judged.
struct Evidence {
  double delta_bic{};     // BIC without − BIC with it; positive speaks for it
  double p_value{1.0};    // likelihood ratio, corrected for search locations and candidates tried
  double heldout_gain{};  // log-likelihood of held-out blocks with it − without, in nats
};

/// A candidate as it stood when nothing else explained its share: in the model of all other causes found.
struct CandidateResult {
  std::size_t index{};  // into Study::causes()
  Evidence evidence;
  bool passed{};
  std::string objection;  // why it did not pass: "not away from zero", "k3_ratio = 9.1 outside 0.5 to 2"
};

/// One cause, or nuisance term, of the extended model.
struct Finding {
  std::size_t index{};  // into Study::causes()
  std::vector<ParameterValue> parameters;
  Evidence evidence;
  double share_of_explainable{};  // variance that is lost without it / variance above the noise floor
  std::vector<std::string> indistinguishable_from;  // causes, or pairs ("a + b"), that would do as well
  NullEvidence simulated{};                         // all zeros where it was not judged by simulation
};

struct GainEstimate {
  double reduction{};  // 1 − extended / nominal held-out RMSE
  double low{};        // 95 % interval, block bootstrap
  double high{};
};

/// What is left after everything that was found.
struct Unexplained {
  double
      share_of_residual_variance{};  // of the nominal residual's variance above the floor, still unexplained
  double ljung_box_p{1.0};
  double runs_p{1.0};
  std::string signature;  // in words: order, window, regressor and shape; empty where nothing stands out
  /// The same of what the nuisance terms describe, where one of them is a free curve, whose numbers say
  /// nothing.
  std::string described;
};

struct Diagnosis {
  Verdict verdict{Verdict::kNoEffect};
  ModelFit nominal;
  ModelFit extended;              // equal to `nominal` where nothing was found
  std::vector<double> weights;    // 0 where a sample was taken for an outlier
  double nominal_heldout_rmse{};  // SI
  double extended_heldout_rmse{};
  double noise_floor{};
  std::vector<Finding> causes;              // strongest first
  std::vector<Finding> nuisance_terms;      // structure without a name
  std::vector<CandidateResult> candidates;  // all, strongest first
  GainEstimate gain;
  Unexplained residual;
  /// Of the nominal model, and of the extended one as it is simulated: structure without a name is in
  /// neither.
  TrustedRegions trusted;
  /// In words, what the records leave open of the numbers above, of both models.
  std::vector<std::string> open;
  std::vector<std::string> notes;  // what a reader should know: parameters out of range, outliers left out
};

struct DiagnoseOptions {
  double family_error{0.006};  // share of clean records in which anything at all may be found
  std::size_t max_effects{8};
  /// Causes that the model has already: in the nominal model of this run, refitted, not reported as found.
  std::vector<std::size_t> given_causes;
  unsigned long long seed{1};                                                // of the bootstrap
  std::function<void(const std::string& step, double share_done)> progress;  // may be empty
  ParallelFor parallel{InTurn};  // over candidates, and over held-out folds; changes no bit
  /// Records without the causes found: a cause that is named as clearly in some of them is dropped. Empty: no
  /// cause is judged so.
  SimulateNull simulate;
  /// Ends as soon as it is known what is found: of the Diagnosis causes and nuisance terms with their
  /// evidence, and the candidates; no parameters, rivals, gain, nor words of what is left.
  bool names_only{};
};

/// Finds what the nominal model of a study lacks.
///
/// Forward selection by BIC under autoregressive noise; a step is taken for a candidate whose corrected
/// p-value, held-out likelihood and parameters all pass. Backward check, and exchange of a cause for a better
/// one, after each step. Causes that would fit as well (within 6 of BIC) in a found one's place are its
/// rivals. Nuisance terms take part, so that unexplained structure is not credited to the cause nearest to
/// it.
///
/// @throws std::invalid_argument if the record is too short to hold anything out.
Diagnosis Diagnose(const Study& study, const DiagnoseOptions& options = {});

}  // namespace strainwave::analysis::diagnosis
