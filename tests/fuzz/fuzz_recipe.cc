// SPDX-License-Identifier: Apache-2.0
// Any JSON as the recipe of a predictor, and as the baseline of a reducer, sealed as it came: refused in
// words, or of use.
#include <cstdint>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>

#include "bench/errors/bench_error.h"
#include "bench/prediction/baseline_file.h"
#include "bench/prediction/feature_recipe.h"
#include "bench/prediction/sealed_json.h"
#include "bench/prediction/signal_inputs.h"
#include "tests/fuzz/file_in_memory.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace strainwave::bench;
  using Json = nlohmann::ordered_json;
  Json json = Json::parse(data, data + size, nullptr, false);
  if (json.is_discarded()) return 0;
  try {
    const FeatureRecipe recipe = RecipeFrom(json.is_object() ? json.value("recipe", json) : json, "any.json");
    try {
      (void)SignalInputs(recipe);
    } catch (const std::invalid_argument&) {
    }
    if (!json.is_object()) return 0;
    json.erase("sha256");
    Seal(json);
    const std::string text = json.dump();
    const FileInMemory file(std::as_bytes(std::span(text)));
    FeatureRecipe asked = recipe;
    asked.baseline_records = 1;
    (void)BaselineFor(asked, {"k1_Nm_per_rad"}, file.path());
  } catch (const BenchError&) {
  } catch (const Json::exception&) {
    if (json.is_object() && !json.contains("sha256")) return 0;  // no UTF-8, which no seal is made of
    std::abort();
  }
  return 0;
}
