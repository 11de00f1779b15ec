// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "analysis/diagnosis/detection_curve.h"
#include "analysis/diagnosis/diagnose.h"

namespace strainwave::analysis::diagnosis {

/// What the search said of one record with an effect planted into it.
struct PlantedOutcome {
  double amount{};  // of the effect, in its unit
  double sigma{};   // standard errors that it stands out by (ResampledNoise::MatchedFilterSigma)
  bool found{};     // its name was given
  std::vector<std::string> others;  // names given beside it that were neither planted nor in the record
};

/// The size that is found with kDetectionProbability, with a 95 % interval; `high` infinite where the trials
/// set no bound.
struct DetectedFrom {
  double value{};
  double low{};
  double high{};
};

/// How large a cause has to be in these records to be found.
struct CausePower {
  std::size_t cause{};  // into Study::causes(): of several forms with one amount the simplest
  std::string amount;   // parameter that says how large it is, "amplitude_arcmin"
  std::string unit;
  std::optional<DetectedFrom> size;    // nothing: not found so often at any size
  std::optional<DetectedFrom> sigma;   // the same in standard errors
  std::string objection;               // where there is no size: why, as far as the search tells
  std::vector<PlantedOutcome> trials;  // as they were made

  std::size_t found() const;
  /// Trials with a name that was neither planted nor in the record.
  std::size_t with_others() const;
  /// Trials of `size` and more; and those of them that were found.
  std::size_t beyond() const;
  std::size_t found_beyond() const;
};

struct DetectionPower {
  std::vector<CausePower> causes;            // in the order of Study::causes()
  std::vector<std::string> cannot_be_drawn;  // causes of which no draw shows in these records
  std::vector<PlantedOutcome> without;       // records without any effect, but for what was found in them
  std::string refusal;                       // why nothing could be planted; empty where it was
  std::size_t searches{};

  std::size_t without_with_others() const;
};

/// Plants each named cause of a study, one at a time and at growing size, into its records as they were found
/// to be: the extended model's response and noise like that which it leaves (ResampledNoise), anew in each
/// trial, as the effect's nonlinear parameters are (Study::DrawEffect). The same search runs on
/// each.
///
/// Sizes converge on the one that is found with kDetectionProbability (NextLnSizes): at least 12 trials, at
/// most 28, fewer where the interval is narrow or nothing is found at the largest size. A cause that the
/// records have is taken out of them before it is planted. On any number of threads the same bits.
///
/// @param diagnosis  of the same study
/// @param options  as the diagnosis had them; `simulate` is left out
DetectionPower MeasureDetectionPower(const Study& study, const Diagnosis& diagnosis,
                                     const DiagnoseOptions& options);

}  // namespace strainwave::analysis::diagnosis
