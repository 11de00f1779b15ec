// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "analysis/diagnosis/detection_power.h"
#include "analysis/diagnosis/diagnose.h"
#include "analysis/diagnosis/sparse_formula.h"
#include "bench/diagnosis/make_study.h"

namespace strainwave::bench {

/// A diagnosis with everything that its reports need: what was measured, and what both come from.
struct DiagnosisReport {
  const StudyInput& input;
  const analysis::diagnosis::Diagnosis& result;
  std::string model;  // the file that the nominal model came from; empty: the kind's own
  /// Nominal parameters before the record was seen; those without one are not there.
  std::vector<analysis::diagnosis::ParameterValue> nominal_before;
  analysis::diagnosis::SparseFormula formula;                  // only where structure has no name
  std::optional<analysis::diagnosis::DetectionPower> power{};  // only where it was asked for
};

/// "effect_found", "no_effect" or "unnamed_structure".
std::string VerdictText(analysis::diagnosis::Verdict verdict);

/// What no cause explains, in words with numbers: the nuisance terms that were needed, and what is left after
/// them. Empty where nothing stands out.
std::string SignatureOf(const DiagnosisReport& report);

/// Measurements that would separate what these records cannot: a comment line, then phases of a schedule as
/// `run` takes them.
std::vector<std::string> MeasurementsToSettle(const DiagnosisReport& report);

/// A candidate's name, in brackets where it is no cause; of several of one name (a drift by time, a drift by
/// temperature) with the parameter that tells them apart.
std::string CandidateName(const analysis::diagnosis::Study& study, std::size_t index);

/// "0.012", "3e-20", "<1e-99": a probability for people.
std::string ProbabilityText(double p);

/// The parameters of a nuisance term but for a free curve's coefficients, which tell nobody anything.
std::vector<analysis::diagnosis::ParameterValue> TellingParameters(
    const analysis::diagnosis::Finding& nuisance_term);

/// "amplitude 0.213 arcmin", "order 7.00 per output turn": a parameter as it is read out.
std::string SpokenParameter(const analysis::diagnosis::ParameterValue& parameter);

}  // namespace strainwave::bench
