// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "analysis/prediction/fit_predictor.h"
#include "bench/prediction/feature_recipe.h"

namespace strainwave::bench {

/// A trained predictor as it lies in its folder: `predictor.json`, and `numbers.h5` beside it.
struct Predictor {
  FeatureRecipe recipe;
  std::vector<std::string> outputs;  // with units: "k2_Nm_per_rad"; where classes are predicted, their names
  analysis::prediction::FittedPredictor fitted;
  std::string training_json;  // an object: from what it was trained, how, and how well it did

  bool classes() const { return fitted.ensemble.softmax; }
};

/// Writes the folder; each file appears whole. @throws DataFileError.
void WritePredictor(const std::filesystem::path& folder, const Predictor& predictor);

/// @throws BenchError if a file is missing, changed since it was written, or does not fit the other.
Predictor ReadPredictor(const std::filesystem::path& folder);

}  // namespace strainwave::bench
