// SPDX-License-Identifier: Apache-2.0
#include "bench/prediction/export_predictor.h"

#include <algorithm>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "bench/campaign/folder.h"
#include "bench/errors/bench_error.h"
#include "bench/prediction/exported_predictor.h"
#include "bench/prediction/model_card.h"
#include "bench/prediction/onnx_model.h"
#include "bench/prediction/onnx_network.h"
#include "bench/prediction/sealed_json.h"
#include "bench/utc.h"
#include "daq/whole_file.h"

namespace strainwave::bench {
namespace {

using Json = nlohmann::ordered_json;

struct Disagreement {
  double over_value{};
  double over_residual{};
};

OnnxNetwork::Predicts PredictsOf(const Predictor& predictor) {
  return predictor.classes() ? OnnxNetwork::Predicts::kClasses : OnnxNetwork::Predicts::kValues;
}

// Records all over the range that was seen in training: its middle, and each input at its least and greatest.
Disagreement Compare(const Predictor& predictor, OnnxNetwork& network) {
  const auto& fitted = predictor.fitted;
  const Eigen::RowVectorXd middle = fitted.ensemble.input.offset;
  const OutputsAre what = WhatOutputsAre(predictor.recipe, PredictsOf(predictor));
  Disagreement worst;
  for (Eigen::Index i = -1; i < 2 * middle.size(); ++i) {
    Eigen::RowVectorXd features = middle;
    if (i >= 0) features(i / 2) = i % 2 == 0 ? fitted.least(i / 2) : fitted.greatest(i / 2);
    const auto trained = fitted.Predict(features);
    const auto exported = network.Run(features);
    const Eigen::ArrayXd off = (trained.value.row(0) - exported.prediction).array().abs();
    const Eigen::ArrayXd size = ComparedOver(what, trained.value.row(0), trained.half_width.row(0));
    worst.over_value = std::max(worst.over_value, (off / size).maxCoeff());
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
            {"predicts", NameOf(PredictsOf(predictor))},
            {"outputs", predictor.outputs},
            {"coverage", predictor.fitted.band.coverage},
            {"guaranteed", predictor.fitted.band.guaranteed},
            {"self_test", std::move(self_test)}};
  Seal(json);
  return json;
}

}  // namespace

ExportSummary ExportPredictor(const Predictor& predictor, const std::filesystem::path& folder) {
  const Json training = Json::parse(predictor.training_json);
  OnnxMetadata metadata{{"data_sha256", training.at("data_sha256").get<std::string>()},
                        {"operating_envelope", predictor.recipe.envelope.Json().dump()}};
  for (std::size_t i = 0; i < predictor.outputs.size(); ++i) {
    metadata.emplace_back(fmt::format("output_{}", i), predictor.outputs[i]);
  }
  const std::string onnx = OnnxBytes(predictor.fitted, metadata);
  OnnxNetwork network(onnx, static_cast<Eigen::Index>(predictor.recipe.inputs.size()),
                      static_cast<Eigen::Index>(predictor.outputs.size()), PredictsOf(predictor));
  const Disagreement worst = Compare(predictor, network);
  const double golden_off = WorstDisagreement(network, GoldenVectors(predictor),
                                              WhatOutputsAre(predictor.recipe, PredictsOf(predictor)));
  if (worst.over_value > kExportAgreement || golden_off > kExportAgreement) {
    throw BenchError(
        ExitCode::kEndedBadly,
        fmt::format("{}: error: read back by OpenCV the network disagrees by {:.1e} of an output "
                    "(expected at most {:.0e}); nothing was written",
                    folder.string(), std::max(worst.over_value, golden_off), kExportAgreement));
  }
  const ModelCard card = ModelCardOf(predictor, UtcNow());
  std::filesystem::create_directories(folder);
  daq::WriteFileAtomically(folder / "model.onnx", onnx);
  daq::WriteFileAtomically(folder / "model_card.json", card.json);
  daq::WriteFileAtomically(folder / "model_card.md", card.markdown);
  // Last: a folder without it is no exported predictor yet.
  daq::WriteFileAtomically(folder / kExportedRecipe,
                           RecipeJson(predictor, onnx, card.json, card.markdown).dump(2) + "\n");
  return {folder,
          onnx.size(),
          predictor.recipe.inputs.size(),
          predictor.outputs.size(),
          predictor.classes(),
          worst.over_value,
          worst.over_residual};
}

}  // namespace strainwave::bench
