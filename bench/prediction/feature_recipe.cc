// SPDX-License-Identifier: Apache-2.0
#include "bench/prediction/feature_recipe.h"

#include <stdexcept>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "bench/errors/bench_error.h"

namespace strainwave::bench {
namespace {

using Json = nlohmann::ordered_json;

// A file that was changed by hand must not ask for the memory of the machine.
constexpr std::size_t kMostInputs = 100'000;

void Require(bool holds, const char* what) {
  if (!holds) throw std::invalid_argument(what);
}

FeatureSettings SettingsFrom(const Json& json) {
  FeatureSettings settings;
  settings.set = FeatureSetOf(json.value("set", "wavelet"));
  if (IsByOrder(settings.set)) {
    settings.orders.edges = json.at("edges").get<std::vector<double>>();
    Require(settings.orders.edges.size() >= 2, "edges has fewer than two orders");
    return settings;
  }
  if (settings.set == FeatureSet::kPackets) {
    settings.packets = {.wavelet = json.at("wavelet").get<std::string>(),
                        .border = analysis::wavelets::BorderOf(json.at("mode").get<std::string>()),
                        .levels = json.at("levels").get<int>(),
                        .normalised_entropy = json.value("normalised_entropy", false)};
    return settings;
  }
  if (settings.set == FeatureSet::kDetails) {
    settings.details = {.wavelet = json.at("wavelet").get<std::string>(),
                        .border = analysis::wavelets::BorderOf(json.at("mode").get<std::string>()),
                        .levels = json.at("levels").get<int>(),
                        .logarithm = json.at("logarithm").get<bool>()};
    return settings;
  }
  settings.wavelet = {.wavelet = json.at("wavelet").get<std::string>(),
                      .border = analysis::wavelets::BorderOf(json.at("mode").get<std::string>()),
                      .levels = json.at("levels").get<int>()};
  return settings;
}

}  // namespace

Json JsonOf(const FeatureRecipe& recipe) {
  Json json{{"set", NameOf(recipe.features.set)}};
  if (IsByOrder(recipe.features.set)) {
    json["edges"] = recipe.features.orders.edges;
  } else if (recipe.features.set == FeatureSet::kPackets) {
    json["wavelet"] = recipe.features.packets.wavelet;
    json["mode"] = analysis::wavelets::NameOf(recipe.features.packets.border);
    json["levels"] = recipe.features.packets.levels;
    json["normalised_entropy"] = recipe.features.packets.normalised_entropy;
    json["coefficients"] = "packets";
  } else if (recipe.features.set == FeatureSet::kDetails) {
    json["wavelet"] = recipe.features.details.wavelet;
    json["mode"] = analysis::wavelets::NameOf(recipe.features.details.border);
    json["levels"] = recipe.features.details.levels;
    json["coefficients"] = "reconstructed details";
    json["logarithm"] = recipe.features.details.logarithm;
  } else {
    json["wavelet"] = recipe.features.wavelet.wavelet;
    json["mode"] = analysis::wavelets::NameOf(recipe.features.wavelet.border);
    json["levels"] = recipe.features.wavelet.levels;
    json["coefficients"] = "approximation";
  }
  json["channels"] = recipe.channels;
  json["sample_rate_hz"] = recipe.sample_rate_hz;
  json["decimates"] = recipe.decimates;
  json["window"] = {{"samples", recipe.window.samples}, {"turns", recipe.window.turns}};
  json["least_samples"] = recipe.least_samples;
  json["baseline_records"] = recipe.baseline_records;
  json["operating_envelope"] = recipe.envelope.Json();
  json["inputs"] = recipe.inputs;
  return json;
}

FeatureRecipe RecipeFrom(const Json& json, const std::filesystem::path& file) {
  try {
    FeatureRecipe recipe{.features = SettingsFrom(json),
                         .channels = json.at("channels").get<std::vector<std::string>>(),
                         .sample_rate_hz = json.at("sample_rate_hz").get<double>(),
                         .decimates = json.value("decimates", false),
                         .window = {},
                         .least_samples = json.at("least_samples").get<std::size_t>(),
                         .baseline_records = json.value("baseline_records", 0),
                         .envelope = {},
                         .inputs = json.at("inputs").get<std::vector<std::string>>()};
    if (json.contains("window")) {
      recipe.window = {json.at("window").at("samples").get<std::size_t>(),
                       json.at("window").at("turns").get<int>()};
    }
    if (json.contains("operating_envelope"))
      recipe.envelope = OperatingEnvelope::From(json.at("operating_envelope"));
    ChannelFeatures{recipe.features};  // throws for a wavelet, levels or edges that there are not
    Require(recipe.sample_rate_hz > 0.0, "sample_rate_hz is not above 0");
    Require(recipe.baseline_records >= 0, "baseline_records is below 0");
    Require(recipe.window.turns >= 0, "window.turns is below 0");
    Require(!recipe.channels.empty() && !recipe.inputs.empty(), "channels or inputs is empty");
    Require(recipe.inputs.size() <= kMostInputs, "inputs has more than 100000 names");
    return recipe;
  } catch (const std::exception& error) {
    Refuse(file, fmt::format("the recipe cannot be used: {}", error.what()),
           "the file as `strainwave train` or `export` has written it");
  }
}

}  // namespace strainwave::bench
