// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "analysis/features/wavelet_features.h"
#include "analysis/prediction/fit_predictor.h"

namespace strainwave::bench {

/// How a record becomes the inputs of a predictor. What is not like it is refused, not resampled.
struct FeatureRecipe {
  analysis::features::WaveletRecipe wavelet;
  std::vector<std::string> channels;  // columns of the record, in this order
  double sample_rate_hz{};
  std::size_t least_samples{};      // of a record
  std::vector<std::string> inputs;  // the features that are kept, by name, in the networks' order
};

/// A trained predictor as it lies in its folder: `predictor.json`, and `numbers.h5` beside it.
struct Predictor {
  FeatureRecipe recipe;
  std::vector<std::string> outputs;  // with units: "k2_Nm_per_rad"
  analysis::prediction::FittedPredictor fitted;
  std::string training_json;  // an object: from what it was trained, how, and how well it did
};

/// Writes the folder; each file appears whole. @throws DataFileError.
void WritePredictor(const std::filesystem::path& folder, const Predictor& predictor);

/// @throws CampaignError if a file is missing, changed since it was written, or does not fit the other.
Predictor ReadPredictor(const std::filesystem::path& folder);

/// The recipe as it also stands beside an exported network.
nlohmann::ordered_json JsonOf(const FeatureRecipe& recipe);
/// @throws CampaignError, naming `file` and the key.
FeatureRecipe RecipeFrom(const nlohmann::ordered_json& json, const std::filesystem::path& file);

}  // namespace strainwave::bench
