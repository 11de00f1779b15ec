// SPDX-License-Identifier: Apache-2.0
#include "bench/prediction/exported_predictor.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <set>
#include <stdexcept>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "bench/errors/bench_error.h"
#include "bench/json_text.h"
#include "bench/prediction/baseline_file.h"
#include "bench/prediction/sealed_json.h"

namespace strainwave::bench {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kExportAsWritten = "the file as `strainwave export` wrote it";
constexpr const char* kExportFolder = "a folder that `strainwave export` wrote";
constexpr std::size_t kMostNames = 256;

// Names go into topics, labels and tables: letters, digits and '_', each once.
void RequireNames(const std::filesystem::path& file, const char* what,
                  const std::vector<std::string>& names) {
  const auto is_plain = [](const std::string& name) {
    return !name.empty() && name.size() <= 100 && std::ranges::all_of(name, [](unsigned char letter) {
      return letter < 128 && (std::isalnum(letter) != 0 || letter == '_');
    });
  };
  const bool unique = std::set<std::string>(names.begin(), names.end()).size() == names.size();
  if (names.empty() || names.size() > kMostNames || !unique || !std::ranges::all_of(names, is_plain)) {
    Refuse(file, fmt::format("the {} have no proper names", what),
           fmt::format("1 to {} different names of letters, digits and '_'", kMostNames));
  }
}

Eigen::RowVectorXd RowFrom(const Json& json, std::size_t size) {
  const auto values = json.get<std::vector<double>>();
  if (values.size() != size) {
    throw std::invalid_argument(
        fmt::format("a golden vector has {} values in place of {}", values.size(), size));
  }
  return Eigen::Map<const Eigen::RowVectorXd>(values.data(), static_cast<Eigen::Index>(size));
}

// The description says of itself what it was, and of each file beside it.
void RequireUnchanged(const std::filesystem::path& folder, const std::filesystem::path& file,
                      const Json& json) {
  RequireSeal(file, json);
  for (const char* card : {"model_card_json", "model_card_md"}) {
    ReadListed(folder, json.at(card), kExportFolder);
  }
}

}  // namespace

OutputsAre WhatOutputsAre(const FeatureRecipe& recipe, OnnxNetwork::Predicts predicts) {
  if (predicts == OnnxNetwork::Predicts::kClasses) return OutputsAre::kClasses;
  // The health of a component may be next to nothing, too, and so may be how far a fault is there.
  const FeatureSet set = recipe.features.set;
  const bool near_zero = recipe.baseline_records > 0 || set == FeatureSet::kPackets ||
                         set == FeatureSet::kDetails || set == FeatureSet::kEnvelopeOrders;
  return near_zero ? OutputsAre::kChanges : OutputsAre::kValues;
}

Eigen::ArrayXd ComparedOver(OutputsAre what, const Eigen::RowVectorXd& value,
                            const Eigen::RowVectorXd& half_width) {
  if (what == OutputsAre::kClasses) return Eigen::ArrayXd::Ones(value.size());
  const Eigen::ArrayXd size = value.transpose().array().abs();
  return what == OutputsAre::kChanges ? size.max(half_width.transpose().array()).eval() : size;
}

double WorstDisagreement(OnnxNetwork& network, std::span<const GoldenVector> golden, OutputsAre what) {
  double worst = 0.0;
  for (const GoldenVector& vector : golden) {
    const OnnxNetwork::Output got = network.Run(vector.features);
    const OnnxNetwork::Output& expected = vector.expected;
    if (got.prediction.size() != expected.prediction.size() ||
        got.half_width.size() != expected.half_width.size()) {
      throw std::invalid_argument("golden vectors have another number of outputs than the network");
    }
    const Eigen::ArrayXd size = ComparedOver(what, expected.prediction, expected.half_width);
    const auto off = [&](const Eigen::RowVectorXd& a, const Eigen::RowVectorXd& b) {
      return ((a - b).transpose().array().abs() / size).maxCoeff();
    };
    for (const double share :
         {off(got.prediction, expected.prediction), off(got.half_width, expected.half_width),
          std::abs(got.distance - expected.distance) / std::max(1.0, std::abs(expected.distance))}) {
      // Written so that a NaN is the worst of all.
      if (!(share <= worst)) worst = std::isnan(share) ? std::numeric_limits<double>::infinity() : share;
    }
  }
  return worst;
}

ExportedPredictor::Parts ExportedPredictor::Read(const std::filesystem::path& folder) {
  const std::filesystem::path file = folder / kExportedRecipe;
  const std::string text = ReadBounded(file, kExportFolder);
  try {
    const Json json = ParseJson(text);
    if (json.at("format") != kExportFormat) {
      Refuse(file, fmt::format("format {}", ShortText(json.at("format"))),
             fmt::format("format {}; export the predictor again", kExportFormat));
    }
    RequireUnchanged(folder, file, json);
    const bool classes = json.at("predicts") == NameOf(OnnxNetwork::Predicts::kClasses);
    if (!classes && json.at("predicts") != NameOf(OnnxNetwork::Predicts::kValues)) {
      Refuse(file, fmt::format("it predicts {}", ShortText(json.at("predicts"))), "values or classes");
    }
    Parts parts{.recipe = RecipeFrom(json.at("recipe"), file),
                .predicts = classes ? OnnxNetwork::Predicts::kClasses : OnnxNetwork::Predicts::kValues,
                .outputs = json.at("outputs").get<std::vector<std::string>>(),
                .coverage = json.at("coverage").get<double>(),
                .golden = {},
                .onnx = ReadListed(folder, json.at("model"), kExportFolder)};
    RequireNames(file, "outputs", parts.outputs);
    RequireNames(file, "channels", parts.recipe.channels);
    if (!(parts.recipe.sample_rate_hz > 0.0) ||
        (!classes && !(parts.coverage > 0.0 && parts.coverage < 1.0))) {
      Refuse(file, "sample_rate_hz or coverage is out of range", kExportAsWritten);
    }
    for (const Json& golden : json.at("self_test")) {
      parts.golden.push_back(
          {RowFrom(golden.at("features"), parts.recipe.inputs.size()),
           {RowFrom(golden.at("prediction"), parts.outputs.size()),
            RowFrom(golden.at("half_width"), parts.outputs.size()), golden.at("distance").get<double>()}});
    }
    if (parts.golden.empty()) Refuse(file, "there is no golden vector", kExportAsWritten);
    return parts;
  } catch (const Json::exception& error) {
    Refuse(file, fmt::format("cannot be used: {}", error.what()), kExportAsWritten);
  } catch (const std::invalid_argument& error) {
    Refuse(file, fmt::format("cannot be used: {}", error.what()), kExportAsWritten);
  }
}

namespace {

SignalInputs InputsOf(const std::filesystem::path& folder, const FeatureRecipe& recipe) {
  try {
    return SignalInputs(recipe);
  } catch (const std::invalid_argument& error) {
    Refuse(folder / kExportedRecipe, fmt::format("cannot be used: {}", error.what()), kExportAsWritten);
  }
}

OnnxNetwork NetworkOf(const std::filesystem::path& folder, const std::string& onnx, std::size_t inputs,
                      std::size_t outputs, OnnxNetwork::Predicts predicts) {
  try {
    return {onnx, static_cast<Eigen::Index>(inputs), static_cast<Eigen::Index>(outputs), predicts};
  } catch (const std::invalid_argument& error) {
    throw BenchError(ExitCode::kWrongInput,
                     fmt::format("{}: error: {}", (folder / "model.onnx").string(), error.what()));
  }
}

}  // namespace

ExportedPredictor::ExportedPredictor(const std::filesystem::path& folder)
    : folder_(folder),
      parts_(Read(folder)),
      inputs_(InputsOf(folder, parts_.recipe)),
      network_(NetworkOf(folder, parts_.onnx, parts_.recipe.inputs.size(), parts_.outputs.size(),
                         parts_.predicts)),
      worst_disagreement_(
          WorstDisagreement(network_, parts_.golden, WhatOutputsAre(parts_.recipe, parts_.predicts))) {
  if (!(worst_disagreement_ <= kExportAgreement)) {
    Refuse(folder / "model.onnx",
           fmt::format("the self-test fails: off the golden vectors by {:.1e}", worst_disagreement_),
           fmt::format("at most {:.0e}", kExportAgreement));
  }
  parts_.onnx.clear();
}

SignalNeeds ExportedPredictor::needs() const {
  const FeatureRecipe& recipe = parts_.recipe;
  return {.records = recipe.features.set == FeatureSet::kPackets ? daq::RecordKind::kMotor
                                                                 : daq::RecordKind::kVibration,
          .signals = recipe.signals(),
          .window = recipe.window,
          .least_samples = recipe.least_samples};
}

void ExportedPredictor::UseBaseline(const std::filesystem::path& file) {
  baseline_ = BaselineFor(parts_.recipe, parts_.outputs, file);
}

OnnxNetwork::Output ExportedPredictor::RunSinceBaseline(const Eigen::RowVectorXd& features) {
  if (!baseline_) return network_.Run(features);
  OnnxNetwork::Output output = network_.Run(features - baseline_->features);
  output.prediction += baseline_->values;
  return output;
}

std::variant<PredictedOutputs, SignalFault> ExportedPredictor::Predict(std::span<const NamedSignal> signals,
                                                                       double sample_rate_hz,
                                                                       std::optional<double> samples_per_turn,
                                                                       const OperatingPoint& operating) {
  if (auto fault = inputs_.Compute(signals, sample_rate_hz, samples_per_turn, features_))
    return *std::move(fault);
  if ((parts_.recipe.baseline_records > 0) != baseline_.has_value()) {
    throw std::logic_error("a predictor of changes was run without a baseline");
  }
  const OnnxNetwork::Output output = RunSinceBaseline(features_);
  PredictedOutputs predicted{.value = {output.prediction.begin(), output.prediction.end()},
                             .half_width = {output.half_width.begin(), output.half_width.end()},
                             .distance = output.distance,
                             .left = parts_.recipe.envelope.Left(operating)};
  if (!output.prediction.allFinite() || !output.half_width.allFinite() || !std::isfinite(output.distance)) {
    return SignalFault{SignalFaultKind::kUndefined,
                       "the prediction is not a number (expected signals like those trained on)"};
  }
  if (predicted.distance <= 1.0) return predicted;
  const std::vector<std::string>& channels = parts_.recipe.channels;
  for (std::size_t i = 0; i < channels.size(); ++i) {
    for (std::size_t j = i + 1; j < channels.size(); ++j) {
      if (!(RunSinceBaseline(inputs_.WithExchanged(i, j)).distance <= 1.0)) continue;
      return SignalFault{SignalFaultKind::kSwapped,
                         fmt::format("{} and {} seem to be exchanged (expected the sensors as in training)",
                                     channels[i], channels[j])};
    }
  }
  return predicted;
}

}  // namespace strainwave::bench
