// SPDX-License-Identifier: Apache-2.0
#include "bench/prediction/baseline_file.h"

#include <stdexcept>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "bench/errors/bench_error.h"
#include "bench/json_text.h"
#include "bench/prediction/sealed_json.h"

namespace strainwave::bench {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kFormat = 1;
constexpr const char* kBaselineAsWritten = "a file as `strainwave baseline` writes it";

Json ByName(const std::vector<std::string>& names, const Eigen::RowVectorXd& values) {
  Json json = Json::object();
  for (std::size_t i = 0; i < names.size(); ++i) json[names[i]] = values(static_cast<Eigen::Index>(i));
  return json;
}

// How a feature of a name is computed; which of them a predictor takes does not matter.
Json FeaturesJson(const FeatureRecipe& recipe) {
  Json json = JsonOf(recipe);
  for (const char* of_one_predictor :
       {"channels", "inputs", "least_samples", "baseline_records", "decimates", "operating_envelope"})
    json.erase(of_one_predictor);
  return json;
}

Eigen::RowVectorXd Chosen(const Json& values, const std::vector<std::string>& names,
                          const std::filesystem::path& file, const char* what) {
  Eigen::RowVectorXd row(static_cast<Eigen::Index>(names.size()));
  for (std::size_t i = 0; i < names.size(); ++i) {
    const auto found = values.find(names[i]);
    if (found == values.end()) {
      Refuse(file, fmt::format("there is no baseline of {}", names[i]),
             fmt::format("one of every {} of the predictor", what));
    }
    row(static_cast<Eigen::Index>(i)) = found->get<double>();
  }
  return row;
}

Json ReadUnchanged(const std::filesystem::path& file) {
  Json json = ParseJson(ReadBounded(file, kBaselineAsWritten));
  if (json.at("format").get<int>() != kFormat) {
    Refuse(file, fmt::format("format {}", ShortText(json.at("format"))), fmt::format("format {}", kFormat));
  }
  RequireSeal(file, json);
  return json;
}

}  // namespace

std::string BaselineText(const ReducerBaseline& baseline) {
  Json json{{"format", kFormat},
            {"specimen", baseline.specimen},
            {"records", baseline.records},
            {"recipe", FeaturesJson(baseline.recipe)},
            {"features", ByName(baseline.recipe.inputs, baseline.means.features)},
            {"values", ByName(baseline.outputs, baseline.means.values)}};
  Seal(json);
  return json.dump(2) + "\n";
}

std::optional<analysis::prediction::Baseline> BaselineFor(const FeatureRecipe& recipe,
                                                          const std::vector<std::string>& outputs,
                                                          const std::filesystem::path& file) {
  if (recipe.baseline_records == 0) {
    if (!file.empty()) Refuse(file, "the predictor takes no baseline", "none");
    return std::nullopt;
  }
  if (file.empty()) {
    throw BenchError(
        ExitCode::kWrongInput,
        fmt::format("error: the predictor tells changes since a reducer's first {} records (expected its "
                    "baseline file, as `strainwave baseline` writes it)",
                    recipe.baseline_records));
  }
  try {
    const Json json = ReadUnchanged(file);
    const Json wanted = FeaturesJson(recipe);
    const Json& own = json.at("recipe");
    for (const auto& [key, value] : wanted.items()) {
      if (own.value(key, Json()) == value) continue;
      Refuse(file, fmt::format("{} of its features is {}", key, ShortText(own.value(key, Json()))),
             fmt::format("{}, as the predictor's", value.dump()));
    }
    return analysis::prediction::Baseline{Chosen(json.at("features"), recipe.inputs, file, "input"),
                                          Chosen(json.at("values"), outputs, file, "output")};
  } catch (const Json::exception& error) {
    Refuse(file, fmt::format("cannot be used: {}", error.what()), kBaselineAsWritten);
  } catch (const std::invalid_argument& error) {
    Refuse(file, fmt::format("cannot be used: {}", error.what()), kBaselineAsWritten);
  }
}

}  // namespace strainwave::bench
