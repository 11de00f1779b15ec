// SPDX-License-Identifier: Apache-2.0
#include "bench/prediction/export_predictor.h"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "bench/campaign/campaign_error.h"
#include "bench/campaign/folder.h"
#include "bench/prediction/exported_predictor.h"
#include "bench/prediction/onnx_model.h"
#include "bench/prediction/onnx_network.h"
#include "daq/whole_file.h"

namespace strainwave::bench {
namespace {

using Json = nlohmann::ordered_json;

struct Disagreement {
  double over_value{};
  double over_residual{};
};

// Records all over the range that was seen in training: its middle, and each input at its least and greatest.
Disagreement Compare(const Predictor& predictor, OnnxNetwork& network) {
  const auto& fitted = predictor.fitted;
  const Eigen::RowVectorXd middle = fitted.ensemble.input.offset;
  Disagreement worst;
  for (Eigen::Index i = -1; i < 2 * middle.size(); ++i) {
    Eigen::RowVectorXd features = middle;
    if (i >= 0) features(i / 2) = i % 2 == 0 ? fitted.least(i / 2) : fitted.greatest(i / 2);
    const auto trained = fitted.Predict(features);
    const auto exported = network.Run(features);
    const Eigen::ArrayXd off = (trained.value.row(0) - exported.prediction).array().abs();
    worst.over_value =
        std::max(worst.over_value, (off / trained.value.row(0).transpose().array().abs()).maxCoeff());
    worst.over_residual =
        std::max(worst.over_residual, (off / fitted.residual.transpose().array()).maxCoeff());
  }
  return worst;
}

// The middle of what was trained on, and its two far corners.
std::vector<GoldenVector> GoldenVectors(const Predictor& predictor) {
  const auto& fitted = predictor.fitted;
  std::vector<GoldenVector> golden;
  for (const Eigen::RowVectorXd& features :
       {Eigen::RowVectorXd(fitted.ensemble.input.offset), fitted.least, fitted.greatest}) {
    const auto trained = fitted.Predict(features);
    golden.push_back({features, {trained.value.row(0), trained.half_width.row(0), trained.distance(0)}});
  }
  return golden;
}

Json ListOf(const Eigen::RowVectorXd& row) { return std::vector<double>(row.begin(), row.end()); }

Json FileJson(const char* file, const std::string& content) {
  return {{"file", file}, {"sha256", Sha256(content)}};
}

Json RecipeJson(const Predictor& predictor, const std::string& onnx, const std::string& card_json,
                const std::string& card_text) {
  Json model = FileJson("model.onnx", onnx);
  model["opset"] = kOnnxOpset;
  Json self_test = Json::array();
  for (const GoldenVector& golden : GoldenVectors(predictor)) {
    self_test.push_back({{"features", ListOf(golden.features)},
                         {"prediction", ListOf(golden.expected.prediction)},
                         {"half_width", ListOf(golden.expected.half_width)},
                         {"distance", golden.expected.distance}});
  }
  Json json{{"format", kExportFormat},
            {"model", std::move(model)},
            {"model_card_json", FileJson("model_card.json", card_json)},
            {"model_card_md", FileJson("model_card.md", card_text)},
            {"recipe", JsonOf(predictor.recipe)},
            {"outputs", predictor.outputs},
            {"coverage", predictor.fitted.band.coverage},
            {"guaranteed", predictor.fitted.band.guaranteed},
            {"self_test", std::move(self_test)}};
  json["sha256"] = Sha256(json.dump());  // of all that stands before it
  return json;
}

Json CardJson(const Predictor& predictor, const std::string& date) {
  const auto& fitted = predictor.fitted;
  Json range;
  for (std::size_t i = 0; i < predictor.recipe.inputs.size(); ++i) {
    const auto column = static_cast<Eigen::Index>(i);
    range[predictor.recipe.inputs[i]] = {fitted.least(column), fitted.greatest(column)};
  }
  return {{"exported_utc", date},
          {"outputs", predictor.outputs},
          {"training", Json::parse(predictor.training_json)},
          {"valid_range", std::move(range)}};
}

std::string CardText(const Predictor& predictor, const Json& card) {
  const Json& training = card.at("training");
  std::string text = fmt::format(
      "# Predictor of {}\n\nFrom the vibration of a measurement rotation ({} at {:g} Hz, at least {} "
      "samples). Exported {}.\n\n"
      "## Trained on\n\n| campaign | specimen | records |\n| --- | --- | --- |\n",
      fmt::join(predictor.outputs, ", "), fmt::join(predictor.recipe.channels, ", "),
      predictor.recipe.sample_rate_hz, predictor.recipe.least_samples,
      card.at("exported_utc").get<std::string>());
  for (const Json& campaign : training.at("campaigns")) {
    text +=
        fmt::format("| {} | {} | {} |\n", campaign.at("folder").get<std::string>(),
                    campaign.at("specimen").get<std::string>(), campaign.at("records").get<std::size_t>());
  }
  text += fmt::format("\nSHA-256 of features and targets: `{}`. Design `{}`, {} networks.\n",
                      training.at("data_sha256").get<std::string>(), training.at("design").get<std::string>(),
                      predictor.fitted.ensemble.members.size());
  for (const Json& split : training.at("splits")) {
    text += fmt::format(
        "\n## Error on {}\n\n{}; trained on {}, tested on {} records. Mean absolute percentage error:\n\n|",
        split.at("split").get<std::string>(), split.at("meaning").get<std::string>(),
        split.at("train").get<std::size_t>(), split.at("test").get<std::size_t>());
    for (const std::string& output : predictor.outputs) text += fmt::format(" | {}", output);
    text += " |\n| ---" + [&] {
      std::string rule;
      for (std::size_t i = 0; i < predictor.outputs.size(); ++i) rule += " | ---";
      return rule;
    }() + " |\n";
    for (const auto& [name, scores] : split.at("scores").items()) {
      text += "| " + name;
      for (const std::string& output : predictor.outputs) {
        text += fmt::format(" | {:.3f}", scores.at(output).at("mape_percent").get<double>());
      }
      text += " |\n";
    }
  }
  text += fmt::format(
      "\n## Intervals\n\nThey hold {:.0f} % of records of {}. Valid where `distance` is at most 1: beyond, a "
      "record lies "
      "outside what was trained on and nothing is promised. The range of each input in training is in "
      "`model_card.json`.\n",
      100.0 * predictor.fitted.band.coverage,
      predictor.fitted.band.guaranteed
          ? "a reducer like those trained on"
          : "those seen; there were too few reducers to promise it for another one");
  return text;
}

}  // namespace

ExportSummary ExportPredictor(const Predictor& predictor, const std::filesystem::path& folder) {
  const Json training = Json::parse(predictor.training_json);
  OnnxMetadata metadata{{"data_sha256", training.at("data_sha256").get<std::string>()}};
  for (std::size_t i = 0; i < predictor.outputs.size(); ++i) {
    metadata.emplace_back(fmt::format("output_{}", i), predictor.outputs[i]);
  }
  const std::string onnx = OnnxBytes(predictor.fitted, metadata);
  OnnxNetwork network(onnx, static_cast<Eigen::Index>(predictor.recipe.inputs.size()),
                      static_cast<Eigen::Index>(predictor.outputs.size()));
  const Disagreement worst = Compare(predictor, network);
  const double golden_off = WorstDisagreement(network, GoldenVectors(predictor));
  if (worst.over_value > kExportAgreement || golden_off > kExportAgreement) {
    throw CampaignError(
        ExitCode::kEndedBadly,
        fmt::format("{}: error: read back by OpenCV the network disagrees by {:.1e} of an output "
                    "(expected at most {:.0e}); nothing was written",
                    folder.string(), std::max(worst.over_value, golden_off), kExportAgreement));
  }
  const Json card = CardJson(predictor, UtcNow());
  std::filesystem::create_directories(folder);
  daq::WriteFileAtomically(folder / "model.onnx", onnx);
  const std::string card_json = card.dump(2) + "\n";
  const std::string card_text = CardText(predictor, card);
  daq::WriteFileAtomically(folder / "model_card.json", card_json);
  daq::WriteFileAtomically(folder / "model_card.md", card_text);
  // Last: a folder without it is no exported predictor yet.
  daq::WriteFileAtomically(folder / "recipe.json",
                           RecipeJson(predictor, onnx, card_json, card_text).dump(2) + "\n");
  return {folder, onnx.size(), predictor.recipe.inputs.size(), predictor.outputs.size(), worst.over_residual};
}

}  // namespace strainwave::bench
