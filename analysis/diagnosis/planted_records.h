// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "analysis/diagnosis/detection_power.h"
#include "analysis/diagnosis/resampled_noise.h"

namespace strainwave::analysis::diagnosis {

/// The records of a diagnosis without noise, and without one cause where they have it.
struct PlantingBase {
  std::vector<double> response;        // SI, one a sample
  std::vector<double> beside_nominal;  // what the nominal model leaves of it
  std::vector<std::string> names;      // of the causes that it has
};

/// What the search said of one planted record, and what it held against the cause where it was not found.
struct PlantingOutcome {
  PlantedOutcome planted;
  std::string objection;
};

/// Records as a diagnosis found them to be, with an effect planted into them and noise drawn anew, and the
/// same search on each. Several threads may search at once.
class PlantedRecords {
 public:
  /// All outlive this.
  PlantedRecords(const Study& study, const Diagnosis& diagnosis, const DiagnoseOptions& options);

  const ResampledNoise& noise() const { return noise_; }

  /// Of the model found, less the causes of this name.
  PlantingBase BaseWithout(const std::string& name) const;

  /// Standard errors that an effect stands out by beside the nominal model.
  /// @param added  SI, one a sample
  double SigmaOf(const PlantingBase& base, const Eigen::VectorXd& added) const;

  /// The same where nothing of it is fitted.
  double SigmaAlone(const Eigen::VectorXd& added) const {
    return noise_.MatchedFilterSigma({added.begin(), added.end()});
  }

  /// Searches the records with an effect of this size, or with none (both null).
  PlantingOutcome Search(const PlantingBase& base, const CauseRule* rule, const DrawnEffect* effect,
                         double amount, std::uint64_t draw) const;

 private:
  std::vector<double> BesideNominal(const std::vector<double>& response) const;

  const Study& study_;
  const Diagnosis& diagnosis_;
  DiagnoseOptions options_;
  ResampledNoise noise_;
};

}  // namespace strainwave::analysis::diagnosis
