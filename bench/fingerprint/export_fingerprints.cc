// SPDX-License-Identifier: Apache-2.0
#include "bench/fingerprint/export_fingerprints.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "analysis/joint_dynamics/nominal.h"
#include "analysis/prediction/fit_predictor.h"
#include "bench/errors/bench_error.h"
#include "bench/fingerprint/exported_fingerprint.h"
#include "bench/fingerprint/fingerprint_names.h"
#include "bench/prediction/exported_predictor.h"
#include "bench/prediction/onnx_model.h"
#include "bench/prediction/onnx_network.h"
#include "bench/prediction/sealed_json.h"
#include "bench/sha256.h"
#include "bench/utc.h"
#include "daq/whole_file.h"

namespace strainwave::bench {
namespace {

namespace dynamics = analysis::joint_dynamics;
namespace prediction = analysis::prediction;
using Eigen::Index;
using Json = nlohmann::ordered_json;

// As the writer of ONNX files takes it: without an interval, the distance from the middle of what was trained
// on.
prediction::FittedPredictor FittedOf(const prediction::Ensemble& ensemble,
                                     const prediction::Novelty& novelty) {
  const Index outputs = ensemble.network.output_size();
  return {.ensemble = ensemble,
          .residual = Eigen::RowVectorXd::Ones(outputs),
          .band = {.coverage = 0.0, .factor = Eigen::RowVectorXd::Zero(outputs), .guaranteed = false},
          .novelty = novelty,
          .least = ensemble.input.offset - ensemble.input.scale,
          .greatest = ensemble.input.offset + ensemble.input.scale};
}

struct ReadBack {
  double worst{};
  Json golden = Json::array();
};

// Rows that the network has been trained on or is told from, through OpenCV and as it was trained.
ReadBack Compare(const prediction::Ensemble& ensemble, const std::string& onnx, const Eigen::MatrixXd& rows,
                 OnnxNetwork::Predicts predicts) {
  OnnxNetwork network(onnx, rows.cols(), ensemble.network.output_size(), predicts);
  ReadBack result;
  constexpr Index kGolden = 3;
  const std::vector<Index> kept = dynamics::EvenRows(rows.rows(), kGolden);
  for (Index row = 0; row < rows.rows(); ++row) {
    const Eigen::RowVectorXd features = rows.row(row);
    const Eigen::RowVectorXd trained = ensemble.Predict(features).mean.row(0);
    const Eigen::RowVectorXd off = (network.Run(features).prediction - trained).cwiseAbs();
    result.worst = std::max(result.worst, off.cwiseQuotient(ensemble.output.scale).maxCoeff());
    if (std::ranges::find(kept, row) == kept.end()) continue;
    result.golden.push_back({{"features", std::vector<double>(features.begin(), features.end())},
                             {"prediction", std::vector<double>(trained.begin(), trained.end())}});
  }
  return result;
}

std::vector<std::string> StateNames(Index joints) {
  return dynamics::NamesOf(dynamics::Fingerprint::kGroup, joints);
}

Json RowsJson(const Eigen::MatrixXd& matrix) {
  Json rows = Json::array();
  for (Index row = 0; row < matrix.rows(); ++row) {
    const Eigen::RowVectorXd values = matrix.row(row);
    rows.push_back(std::vector<double>(values.begin(), values.end()));
  }
  return rows;
}

Json FileOf(const char* file, const std::string& content) {
  return {{"file", file}, {"sha256", Sha256(content)}};
}

Json CardOf(const FingerprintModel& model) {
  const Json training = Json::parse(model.training_json);
  return {{"exported_utc", UtcNow()},
          {"what",
           "whether a robot's joints have a fault, from what a network of healthy units leaves over of their "
           "torques and what its torques come from"},
          {"trained_on", {{"files", training.at("files")}, {"units", training.at("units")}}},
          {"accuracy", training.at("fingerprint").at("network")},
          {"accuracy_from_raw_signals", training.at("raw").at("network")},
          {"limits", training.at("warnings")}};
}

std::string ScoreText(const Json& score) {
  if (score.at("accuracy").is_null()) return "none: " + score.at("reason").get<std::string>();
  return fmt::format("{:.3f} ({:.2f} to {:.2f} with 95 % confidence), counted in {}",
                     score.at("accuracy").get<double>(), score.at("low").get<double>(),
                     score.at("high").get<double>(), score.at("counted").get<std::string>());
}

std::string CardText(const Json& card) {
  std::string text = fmt::format(
      "# Fingerprints of joints\n\n{}.\n\nTrained on {} files of {} units. Accuracy:\n\n| split | "
      "fingerprints | raw signals |\n| --- | --- | --- |\n",
      card.at("what").get<std::string>(), card.at("trained_on").at("files").dump(),
      card.at("trained_on").at("units").dump());
  for (const auto& [split, score] : card.at("accuracy").items())
    text += fmt::format("| {} | {} | {} |\n", split, ScoreText(score),
                        ScoreText(card.at("accuracy_from_raw_signals").at(split)));
  text +=
      "\nThe random split has samples of one file on both sides and flatters; units left out are what a new "
      "unit is.\n";
  for (const auto& limit : card.at("limits")) text += fmt::format("\n- {}", limit.get<std::string>());
  return text + "\n";
}

}  // namespace

FingerprintExport ExportFingerprints(const FingerprintModel& model, const std::filesystem::path& folder) {
  const std::string nominal = OnnxBytes(FittedOf(model.nominal, model.state_novelty), {});
  const std::string classifier = OnnxBytes(FittedOf(model.classifier, model.fingerprint_novelty), {});
  const ReadBack of_nominal =
      Compare(model.nominal, nominal, model.background, OnnxNetwork::Predicts::kValues);
  const ReadBack of_classifier =
      Compare(model.classifier, classifier, model.healthy_fingerprints, OnnxNetwork::Predicts::kClasses);
  const double worst = std::max(of_nominal.worst, of_classifier.worst);
  if (!(worst <= kExportAgreement))
    throw BenchError(
        ExitCode::kEndedBadly,
        fmt::format("{}: error: read back by OpenCV a network disagrees by {:.1e} (expected at most {:.0e}); "
                    "nothing was written",
                    folder.string(), worst, kExportAgreement));
  const Json card = CardOf(model);
  const std::string card_json = card.dump(2) + "\n";
  const std::string card_text = CardText(card);
  const Index joints = model.joints();
  std::vector<std::string> torques;
  for (Index j = 1; j <= joints; ++j) torques.push_back(fmt::format("tau{}_Nm", j));
  Json recipe{{"format", kFingerprintExportFormat},
              {"kind", "fingerprint"},
              {"nominal", FileOf(kNominalOnnx, nominal)},
              {"classifier", FileOf(kClassifierOnnx, classifier)},
              {"opset", kOnnxOpset},
              {"model_card_json", FileOf("model_card.json", card_json)},
              {"model_card_md", FileOf("model_card.md", card_text)},
              {"joints", joints},
              {"filter",
               {{"name", "savitzky_golay"},
                {"window_s", model.smoothing.window_s},
                {"order", model.smoothing.order},
                {"acceleration", model.acceleration_measured ? "measured" : "from_velocity"}}},
              {"samples_per_file", model.samples},
              {"sample_rate_hz", model.sample_rate_hz},
              {"least_samples", std::lround(model.shortest_s * model.sample_rate_hz)},
              {"states", StateNames(joints)},
              {"torques", torques},
              {"torque_scale_Nm",
               std::vector<double>(model.nominal.output.scale.begin(), model.nominal.output.scale.end())},
              {"fingerprint",
               {{"name", dynamics::NameOf(model.attribution.fingerprint)},
                {"method", dynamics::NameOf(model.attribution.method)},
                {"coalitions", model.attribution.coalitions},
                {"seed", model.attribution.seed},
                {"numbers", dynamics::NominalNames(model.attribution.fingerprint, joints)}}},
              {"background", RowsJson(model.background)},
              {"classes", {model.healthy, "faulty"}},
              {"self_test", {{"nominal", of_nominal.golden}, {"classifier", of_classifier.golden}}}};
  Seal(recipe);
  std::filesystem::create_directories(folder);
  daq::WriteFileAtomically(folder / kNominalOnnx, nominal);
  daq::WriteFileAtomically(folder / kClassifierOnnx, classifier);
  daq::WriteFileAtomically(folder / "model_card.json", card_json);
  daq::WriteFileAtomically(folder / "model_card.md", card_text);
  // Last: a folder without it is no exported model yet.
  daq::WriteFileAtomically(folder / kExportedRecipe, recipe.dump(2) + "\n");
  return {folder, of_nominal.worst, of_classifier.worst};
}

}  // namespace strainwave::bench
