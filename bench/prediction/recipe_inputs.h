// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <Eigen/Core>

#include "analysis/features/wavelet_features.h"
#include "bench/prediction/predictor_file.h"
#include "daq/record.h"

namespace strainwave::bench {

/// Turns records into the inputs of a predictor. Keeps its memory from record to record; one object a thread.
class RecipeInputs {
 public:
  /// @throws CampaignError if an input is no feature of the recipe's channels.
  explicit RecipeInputs(const FeatureRecipe& recipe);

  /// @throws CampaignError naming the record and what of it is not as in training: a channel that is missing,
  ///   another rate (by more than a hundredth), too few samples, a dead or a clipped sensor, an input that is
  ///   not defined.
  Eigen::RowVectorXd Of(const daq::Record& record);

 private:
  FeatureRecipe recipe_;
  analysis::features::WaveletFeatures by_wavelet_;
  std::vector<Eigen::Index> place_;  // of each input among all features
  std::vector<double> values_;
};

}  // namespace strainwave::bench
