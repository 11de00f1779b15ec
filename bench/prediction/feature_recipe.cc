// SPDX-License-Identifier: Apache-2.0
#include "bench/prediction/feature_recipe.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "bench/campaign/campaign_error.h"

namespace strainwave::bench {

using Json = nlohmann::ordered_json;

Json JsonOf(const FeatureRecipe& recipe) {
  return {
      {"wavelet", recipe.wavelet.wavelet},     {"mode", analysis::wavelets::NameOf(recipe.wavelet.border)},
      {"levels", recipe.wavelet.levels},       {"coefficients", "approximation"},
      {"channels", recipe.channels},           {"sample_rate_hz", recipe.sample_rate_hz},
      {"least_samples", recipe.least_samples}, {"inputs", recipe.inputs}};
}

FeatureRecipe RecipeFrom(const Json& json, const std::filesystem::path& file) {
  try {
    return {.wavelet = {.wavelet = json.at("wavelet").get<std::string>(),
                        .border = analysis::wavelets::BorderOf(json.at("mode").get<std::string>()),
                        .levels = json.at("levels").get<int>()},
            .channels = json.at("channels").get<std::vector<std::string>>(),
            .sample_rate_hz = json.at("sample_rate_hz").get<double>(),
            .least_samples = json.at("least_samples").get<std::size_t>(),
            .inputs = json.at("inputs").get<std::vector<std::string>>()};
  } catch (const std::exception& error) {
    Refuse(file, fmt::format("the recipe cannot be used: {}", error.what()),
           "the file as `strainwave train` or `export` has written it");
  }
}

}  // namespace strainwave::bench
