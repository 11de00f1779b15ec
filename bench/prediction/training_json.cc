// SPDX-License-Identifier: Apache-2.0
#include "bench/prediction/training_json.h"

#include <utility>

#include <nlohmann/json.hpp>

#include "bench/prediction/network_json.h"

namespace strainwave::bench {
namespace {

namespace prediction = analysis::prediction;
using Json = nlohmann::ordered_json;

Json JsonOf(const prediction::Contestant& contestant, const std::vector<std::string>& outputs) {
  Json json;
  if (contestant.scores.empty()) {
    json["accuracy_percent"] = prediction::Accuracy_percent(contestant.confusion);
    Json rows;
    for (std::size_t own = 0; own < outputs.size(); ++own) {
      for (std::size_t given = 0; given < outputs.size(); ++given) {
        rows[outputs[own]][outputs[given]] =
            contestant.confusion(static_cast<Eigen::Index>(own), static_cast<Eigen::Index>(given));
      }
    }
    json["confusion"] = std::move(rows);
    return json;
  }
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    const prediction::OutputScore& score = contestant.scores[i];
    json[outputs[i]] = {{"nmse", score.nmse}, {"mape_percent", score.mape_percent}, {"rmse", score.rmse}};
  }
  json["mean_mape_percent"] = prediction::MeanMape_percent(contestant.scores);
  return json;
}

Json SourcesJson(const TrainingData& data) {
  Json sources = Json::array();
  for (const TrainingSource& source : data.sources) {
    sources.push_back(
        {{"folder", source.folder}, {"specimen", source.specimen}, {"records", source.records}});
  }
  return sources;
}

Json ScoresJson(const std::vector<prediction::Contestant>& contestants,
                const std::vector<std::string>& outputs) {
  Json scores;
  for (const auto& contestant : contestants) scores[contestant.name] = JsonOf(contestant, outputs);
  return scores;
}

Json SplitsJson(const TrainingOutcome& outcome, const std::vector<std::string>& outputs) {
  Json splits = Json::array();
  for (const SplitResult& split : outcome.splits) {
    splits.push_back({{"split", split.name},
                      {"meaning", split.meaning},
                      {"train", split.train},
                      {"test", split.test},
                      {"scores", ScoresJson(split.contestants, outputs)}});
  }
  return splits;
}

Json FoldsJson(const FoldResult& folds, const std::vector<std::string>& outputs) {
  return {{"of", folds.of},
          {"error_percent", folds.error_percent},
          {"network", JsonOf(folds.contestants.front(), outputs)},
          {"scores", ScoresJson(folds.contestants, outputs)},
          {"interval_coverage",
           std::vector<double>(folds.interval_coverage.begin(), folds.interval_coverage.end())}};
}

Json ImportanceJson(const TrainingOutcome& outcome, bool classes) {
  Json importances = Json::array();
  for (const auto& importance : outcome.importances) {
    importances.push_back(
        {{"inputs", importance.name},
         {classes ? "error_rise_percent" : "mape_rise_percent", importance.error_rise_percent},
         {"se", importance.standard_error_percent}});
  }
  return importances;
}

Json SearchJson(const TrainingOutcome& outcome) {
  Json trials = Json::array();
  for (const prediction::Trial& trial : outcome.trials) {
    trials.push_back({{"hidden", trial.candidate.widths},
                      {"weight_decay", trial.candidate.weight_decay},
                      {"parameters", trial.parameters},
                      {"error_percent", trial.error_percent},
                      {"se", trial.standard_error_percent}});
  }
  return trials;
}

Json CurveJson(const TrainingOutcome& outcome) {
  Json points = Json::array();
  for (const prediction::LearningPoint& point : outcome.curve) {
    points.push_back({{"records", point.count},
                      {"active_error_percent", point.active_percent},
                      {"even_error_percent", point.even_percent}});
  }
  return points;
}

}  // namespace

std::string TrainingJson(const TrainingData& data, const TrainingJob& job,
                         const prediction::EnsembleSettings& settings, const TrainingOutcome& outcome) {
  const bool classes = data.samples.classes;
  const FilterSummary& filter = outcome.filter;
  Json json{{"campaigns", SourcesJson(data)},
            {"data_sha256", data.sha256},
            {"records", data.samples.size()},
            {"predicts", classes ? "classes" : "values"},
            {"design", job.design},
            {"network", JsonOf(settings.design)},
            {"weight_decay", settings.training.weight_decay},
            {"epochs", settings.training.epochs},
            {"seed", job.seed},
            {"baseline_records", job.baseline_records},
            {"filter",
             {{"limit", job.correlation_limit},
              {"records", filter.records},
              {"vibration_features", filter.vibration_features},
              {"vibration_kept", filter.vibration_kept},
              {"torque_features", filter.torque_features},
              {"torque_kept", filter.torque_kept}}},
            {"splits", SplitsJson(outcome, data.samples.outputs)},
            {"worth", JsonOf(outcome.worth, classes)},
            {"importance", ImportanceJson(outcome, classes)},
            {"operating_envelope", data.recipe.envelope.Json()},
            {"notes", data.notes},
            {"warnings", WarningTexts(data.warnings, NamedFiles::kYes)}};
  if (!job.compare_only) json["folds"] = FoldsJson(outcome.folds, data.samples.outputs);
  if (!outcome.trials.empty()) json["search"] = SearchJson(outcome);
  if (!outcome.curve.empty()) json["learning_curve"] = CurveJson(outcome);
  return json.dump();
}

}  // namespace strainwave::bench
