// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Core>

#include "bench/prediction/feature_recipe.h"
#include "daq/record.h"

namespace strainwave::bench {

/// Turns records into the inputs of a predictor. Keeps its memory from record to record; one object a thread.
class RecipeInputs {
 public:
  /// @throws CampaignError if an input is no feature of the recipe's channels.
  explicit RecipeInputs(const FeatureRecipe& recipe);

  /// A row a window; one row where the recipe takes records whole.
  /// @throws CampaignError naming the record and what of it is not as in training: a channel that is missing,
  ///   another rate (by more than a hundredth), too few samples, a dead or a clipped sensor, an input that is
  ///   not defined.
  Eigen::MatrixXd OfWindows(const daq::Record& record);

  /// The inputs of the first window alone: all there is of a record that a monitor cut to one.
  Eigen::RowVectorXd Of(const daq::Record& record) { return OfWindows(record).row(0); }

 private:
  FeatureRecipe recipe_;
  ChannelFeatures features_;
  std::vector<Eigen::Index> place_;  // of each input among all features
};

}  // namespace strainwave::bench
