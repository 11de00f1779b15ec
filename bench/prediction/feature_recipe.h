// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "bench/prediction/feature_settings.h"
#include "bench/prediction/operating_envelope.h"
#include "bench/prediction/signal_settings.h"

namespace strainwave::bench {

/// How a record becomes the inputs of a predictor. What is not like it is refused; nothing is resampled but
/// what comes at a whole multiple of the rate, where the recipe `decimates`.
struct FeatureRecipe {
  FeatureSettings features;
  std::vector<std::string> channels;  // columns of the record, in this order
  double sample_rate_hz{};
  bool decimates{};
  WindowLength window;
  std::size_t least_samples{};      // of a window
  int baseline_records{};           // since which features and outputs are changes (0: they are values)
  OperatingEnvelope envelope{};     // of the records that were trained on
  std::vector<std::string> inputs;  // the features that are kept, by name, in the networks' order

  SignalSettings signals() const { return {channels, sample_rate_hz, decimates}; }
};

/// The recipe as it stands in a predictor's folder and beside an exported network.
nlohmann::ordered_json JsonOf(const FeatureRecipe& recipe);
/// @throws BenchError, naming `file` and the key.
FeatureRecipe RecipeFrom(const nlohmann::ordered_json& json, const std::filesystem::path& file);

}  // namespace strainwave::bench
