// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "analysis/features/wavelet_features.h"

namespace strainwave::bench {

/// How a record becomes the inputs of a predictor. What is not like it is refused, not resampled.
struct FeatureRecipe {
  analysis::features::WaveletRecipe wavelet;
  std::vector<std::string> channels;  // columns of the record, in this order
  double sample_rate_hz{};
  std::size_t least_samples{};      // of a record
  std::vector<std::string> inputs;  // the features that are kept, by name, in the networks' order
};

/// The recipe as it stands in a predictor's folder and beside an exported network.
nlohmann::ordered_json JsonOf(const FeatureRecipe& recipe);
/// @throws CampaignError, naming `file` and the key.
FeatureRecipe RecipeFrom(const nlohmann::ordered_json& json, const std::filesystem::path& file);

}  // namespace strainwave::bench
