// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "bench/errors/bench_error.h"
#include "bench/json_text.h"
#include "bench/prediction/exported_predictor.h"
#include "bench/prediction/model_card.h"
#include "bench/prediction/network_worth.h"
#include "bench/prediction/predictor_file.h"
#include "bench/prediction/sealed_json.h"
#include "bench/report/filed_papers.h"
#include "bench/report/number_text.h"

namespace strainwave::bench {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kPredictor =
    "a folder of strainwave train --out, with predictor.json, or of strainwave export, with recipe.json";

// The card as `export` writes it; of a folder of `train` it is made here.
std::string CardText(const std::filesystem::path& folder) {
  const std::filesystem::path recipe = folder / kExportedRecipe;
  if (std::filesystem::exists(recipe)) {
    try {
      const Json json = ParseJson(ReadBounded(recipe, kPredictor));
      RequireSeal(recipe, json);
      return ReadListed(folder, json.at("model_card_json"), kPredictor);
    } catch (const nlohmann::json::exception&) {
      Refuse(recipe, "is no recipe of a predictor", kPredictor);
    } catch (const std::invalid_argument&) {
      Refuse(recipe, "is no recipe of a predictor", kPredictor);
    }
  }
  if (!std::filesystem::exists(folder / "predictor.json")) Refuse(folder, "is no predictor", kPredictor);
  return ModelCardOf(ReadPredictor(folder), "").json;
}

ReportTable SourcesTable(const Json& training) {
  ReportTable table{"predictor_sources", {"trained on", "specimen", "records"}, {}};
  for (const Json& source : training.at("campaigns"))
    table.rows.push_back({source.at("folder").get<std::string>(), source.at("specimen").get<std::string>(),
                          std::to_string(source.at("records").get<std::size_t>())});
  return table;
}

// Errors in percent of an output, or of classes the accuracy.
ReportTable ErrorsTable(const Json& card) {
  const Json& training = card.at("training");
  ReportTable table{
      "predictor_errors", {"split", "trained", "tested", "model", "output", "measure", "value"}, {}};
  for (const Json& split : training.at("splits")) {
    const auto add = [&](const std::string& model, const std::string& output, const char* measure,
                         const Json& value) {
      table.rows.push_back({split.at("split").get<std::string>(),
                            std::to_string(split.at("train").get<std::size_t>()),
                            std::to_string(split.at("test").get<std::size_t>()), model, output, measure,
                            value.is_null() ? "–" : With95({value.get<double>(), 0.0})});
    };
    if (split.contains("rmse")) {
      constexpr std::pair<const char*, const char*> kModels[] = {
          {"rmse", "network"}, {"ridge_rmse", "ridge"}, {"mean_rmse", "mean"}};
      for (const auto& [key, model] : kModels) {
        for (const auto& [output, value] : split.at(key).items())
          add(model, output, "root mean square error", value);
      }
      continue;
    }
    for (const auto& [model, scores] : split.at("scores").items()) {
      if (scores.contains("accuracy_percent")) {
        add(model, "class", "accuracy (%)", scores.at("accuracy_percent"));
        continue;
      }
      for (const Json& output : card.at("outputs")) {
        const auto name = output.get<std::string>();
        add(model, name, "mean error (%)", scores.at(name).at("mape_percent"));
      }
    }
  }
  return table;
}

ReportTable RangeTable(const Json& envelope) {
  ReportTable table{"predictor_range", {"operating quantity", "least", "greatest"}, {}};
  for (const auto& [quantity, range] : envelope.items()) {
    table.rows.push_back({quantity, range.is_null() ? "not known" : FiveDigits(range.at(0).get<double>()),
                          range.is_null() ? "not known" : FiveDigits(range.at(1).get<double>())});
  }
  return table;
}

ReportSection CardSection(const std::filesystem::path& folder, const Json& card) {
  ReportSection section{"Predictor", {}};
  const Json& training = card.at("training");
  const auto exported = card.at("exported_utc").get<std::string>();
  section.parts.emplace_back(
      fmt::format("{} from vibration: {}. Trained on {} records, design {}; SHA-256 of features and targets "
                  "{}. From {}{}.",
                  card.at("predicts").get<std::string>() == "classes" ? "Classes" : "Values",
                  fmt::join(card.at("outputs").get<std::vector<std::string>>(), ", "),
                  training.at("records").get<std::size_t>(), training.at("design").get<std::string>(),
                  training.at("data_sha256").get<std::string>(), folder.string(),
                  exported.empty() ? "" : ", exported " + exported));
  if (const std::string worth = WorthSentence(training); !worth.empty()) section.parts.emplace_back(worth);
  section.parts.emplace_back(SourcesTable(training));
  for (const Json& split : training.at("splits"))
    section.parts.emplace_back(
        fmt::format("{}: {}.", split.at("split").get<std::string>(), split.at("meaning").get<std::string>()));
  section.parts.emplace_back(ErrorsTable(card));
  section.parts.emplace_back(
      "Where it can be trusted: where its `distance` is at most 1, and within these operating conditions of "
      "the records that it was trained on. Beyond, nothing is promised.");
  section.parts.emplace_back(RangeTable(card.at("operating_envelope")));
  return section;
}

}  // namespace

ReportSection PredictorSection(const std::filesystem::path& folder) {
  return SectionOfJson(folder, CardText(folder), "predictor", kPredictor,
                       [&](const nlohmann::ordered_json& card) { return CardSection(folder, card); });
}

}  // namespace strainwave::bench
