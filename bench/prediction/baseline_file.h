// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "analysis/prediction/baseline.h"
#include "bench/prediction/feature_recipe.h"

namespace strainwave::bench {

/// What one reducer was like when it was commissioned, as `strainwave baseline` keeps it.
struct ReducerBaseline {
  std::string specimen;
  int records{};         // that the means are of
  FeatureRecipe recipe;  // of the features; its inputs are their names
  std::vector<std::string> outputs;
  analysis::prediction::Baseline means;
};

/// What a baseline file holds.
std::string BaselineText(const ReducerBaseline& baseline);

/// The part of a baseline file that a predictor needs, in its own order.
/// @param file  empty where none was given.
/// @return none for a predictor that needs none.
/// @throws BenchError, naming file and key: the predictor needs a file and there is none, or the other way
///   round; the file was changed, is of other features, or lacks an input or an output.
std::optional<analysis::prediction::Baseline> BaselineFor(const FeatureRecipe& recipe,
                                                          const std::vector<std::string>& outputs,
                                                          const std::filesystem::path& file);

}  // namespace strainwave::bench
