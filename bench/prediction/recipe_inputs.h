// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "bench/prediction/signal_inputs.h"
#include "daq/record.h"

namespace strainwave::bench {

/// Turns records into the inputs of a predictor. Keeps its memory from record to record; one object a thread.
class RecipeInputs {
 public:
  /// @throws BenchError if an input is no feature of the recipe's channels.
  explicit RecipeInputs(const FeatureRecipe& recipe) : recipe_(recipe), inputs_(recipe) {}

  /// A row a window; one row where the recipe takes records whole.
  /// @throws BenchError naming the record and what of it is not as in training (signal_inputs.h), or that
  ///   it tells no speed where windows are so many turns long.
  Eigen::MatrixXd OfWindows(const daq::Record& record);

 private:
  FeatureRecipe recipe_;
  SignalInputs inputs_;
};

}  // namespace strainwave::bench
