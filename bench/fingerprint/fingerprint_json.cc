// SPDX-License-Identifier: Apache-2.0
#include "bench/fingerprint/fingerprint_json.h"

#include <algorithm>
#include <cmath>
#include <set>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "analysis/joint_dynamics/excess_friction.h"
#include "analysis/joint_dynamics/nominal.h"

namespace strainwave::bench {
namespace {

namespace dynamics = analysis::joint_dynamics;
namespace prediction = analysis::prediction;
using Json = nlohmann::ordered_json;

Json NumberOrNull(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

Json ScoreJson(const dynamics::SplitScore& score, bool by_samples) {
  return {{"accuracy", score.accuracy},
          {"auc", NumberOrNull(score.area_under_curve)},
          {"low", score.low},
          {"high", score.high},
          {"counted", by_samples ? "samples" : "files"},
          {"cases", score.cases},
          {"sample_accuracy", score.sample_accuracy},
          {"confusion",
           {{"healthy", {{"healthy", score.confusion(0, 0)}, {"faulty", score.confusion(0, 1)}}},
            {"faulty", {{"healthy", score.confusion(1, 0)}, {"faulty", score.confusion(1, 1)}}}}}};
}

Json NoScore(const std::string& why) {
  return {{"accuracy", nullptr}, {"auc", nullptr}, {"low", nullptr}, {"high", nullptr}, {"reason", why}};
}

Json ScoresOfSplit(const FingerprintOutcome& outcome, const dynamics::ScoreTable& table,
                   const dynamics::FileSplit& split, const std::string& kind) {
  if (const auto why = outcome.impossible.find(split.name); why != outcome.impossible.end())
    return NoScore(why->second);
  const auto found = table.find(split.name);
  if (found == table.end()) return NoScore("with a fold left out, no healthy file is left to learn from");
  return ScoreJson(found->second.at(kind), split.by_samples);
}

Json TableJson(const FingerprintOutcome& outcome, const dynamics::ScoreTable& table) {
  Json json = Json::object();
  for (const prediction::BinaryKind kind : prediction::kBinaryKinds) {
    const std::string name(prediction::NameOf(kind));
    for (const dynamics::FileSplit& split : outcome.splits)
      json[name][split.name] = ScoresOfSplit(outcome, table, split, name);
  }
  return json;
}

Json ExcessFrictionJson(const FingerprintOutcome& outcome) {
  Json json = Json::object();
  for (const dynamics::FileSplit& split : outcome.splits) {
    const bool too_few =
        split.impossible.empty() && !split.by_samples && !outcome.excess_friction.contains(split.name);
    json[split.name] =
        split.by_samples ? NoScore("it is told of whole files")
        : too_few        ? NoScore(fmt::format("with a fold left out, fewer than {} healthy files are left",
                                               dynamics::kFewestHealthyFiles))
                         : ScoresOfSplit(outcome, outcome.excess_friction, split, dynamics::kExcessFriction);
  }
  return json;
}

Json ShuffledJson(const FingerprintOutcome& outcome) {
  Json json = Json::object();
  for (const dynamics::FileSplit& split : outcome.splits)
    json[split.name] = ScoresOfSplit(outcome, outcome.shuffled, split,
                                     std::string(prediction::NameOf(prediction::BinaryKind::kForest)));
  return json;
}

Json ListOf(const Eigen::RowVectorXd& row) { return std::vector<double>(row.begin(), row.end()); }

Json FilesJson(const FingerprintData& data, const FingerprintOutcome& outcome) {
  Json files = Json::array();
  for (std::size_t f = 0; f < data.files.size(); ++f) {
    const FileDynamics& own = outcome.dynamics[f];
    Json file{{"file", data.names[f]},
              {"unit", data.units[f]},
              {"class", data.classes[f]},
              {"mse_Nm2", own.trained.mse_Nm2},
              {"rmse_Nm", ListOf(own.trained.rmse_Nm)},
              {"held_out_rmse_Nm", ListOf(own.held_out.rmse_Nm)},
              {"held_out_explained_share", ListOf(own.held_out.explained_share)},
              {"sample_rate_hz", data.files[f].sample_rate_hz},
              {"window_samples", data.files[f].window},
              {"low_pass_hz", data.files[f].half_power_hz}};
    if (!data.origins.empty()) file["origin"] = data.origins[f];
    if (own.quantity_share.size() == 3)
      file["share"] = {
          {"q", own.quantity_share(0)}, {"qd", own.quantity_share(1)}, {"qdd", own.quantity_share(2)}};
    files.push_back(std::move(file));
  }
  return files;
}

Json RankingsJson(const FingerprintOutcome& outcome) {
  Json rankings = Json::array();
  for (const BackgroundRanking& ranking : outcome.rankings) {
    rankings.push_back({{"background", ranking.name},
                        {"importance", ranking.importance},
                        {"order", ranking.order},
                        {"rank_correlation", ranking.rank_correlation}});
  }
  return rankings;
}

// Units that have files of either class: without them a unit and a fault are the same thing.
std::size_t UnitsOfBoth(const FingerprintData& data) {
  std::set<int> healthy;
  std::set<int> both;
  for (std::size_t f = 0; f < data.facts.files(); ++f) {
    if (data.facts.faulty[f] == 0) healthy.insert(data.facts.unit[f]);
  }
  for (std::size_t f = 0; f < data.facts.files(); ++f) {
    if (data.facts.faulty[f] == 1 && healthy.contains(data.facts.unit[f])) both.insert(data.facts.unit[f]);
  }
  return both.size();
}

}  // namespace

Json TrainingJsonOf(const FingerprintData& data, const FingerprintJob& job,
                    const FingerprintOutcome& outcome) {
  const FingerprintModel& model = *outcome.model;
  const std::set<int> units(data.facts.unit.begin(), data.facts.unit.end());
  std::vector<std::string> warnings = data.warnings;
  warnings.insert(warnings.end(), outcome.warnings.begin(), outcome.warnings.end());
  const std::size_t both = UnitsOfBoth(data);
  if (both == 0)
    warnings.emplace_back(
        "no unit was seen both healthy and faulty: what belongs to a unit and what to its fault "
        "cannot be told apart");
  return {{"kind", "fingerprint_training"},
          {"files", data.files.size()},
          {"units", units.size()},
          {"units_seen_healthy_and_faulty", both},
          {"joints", data.joints()},
          {"samples", outcome.file_of_sample.size()},
          {"healthy_class", data.healthy},
          {"raw", TableJson(outcome, outcome.raw)},
          {"fingerprint", TableJson(outcome, outcome.nominal)},
          {"excess_friction", ExcessFrictionJson(outcome)},
          {"fingerprint_per_file", TableJson(outcome, outcome.per_file)},
          {"shuffled_labels", ShuffledJson(outcome)},
          {"fingerprint_is",
           {{"name", dynamics::NameOf(model.attribution.fingerprint)},
            {"method", dynamics::NameOf(model.attribution.method)},
            {"numbers", dynamics::NominalNames(model.attribution.fingerprint, data.joints())},
            {"per_file_numbers", dynamics::NamesOf(model.attribution.fingerprint, data.joints())},
            {"sums_within", outcome.worst_gap},
            {"mean_standard_error", outcome.mean_standard_error}}},
          {"background",
           {{"name", "healthy"}, {"rows", outcome.background_rows}, {"rankings", RankingsJson(outcome)}}},
          {"filter",
           {{"window_s", data.smoothing.window_s},
            {"order", data.smoothing.order},
            {"acceleration", data.acceleration_measured ? "measured" : "from_velocity"}}},
          {"networks", {{"per_file", data.files.size()}, {"nominal", outcome.networks}}},
          {"explanations_s", outcome.explained_s},
          {"folds", job.folds},
          {"seed", job.seed},
          {"dynamics", FilesJson(data, outcome)},
          {"warnings", warnings}};
}

Json JsonOf(const FileVerdict& verdict, const FingerprintModel& model) {
  Json attribution = Json::object();
  Json residual = Json::object();
  for (std::size_t j = 0; j < verdict.attribution.size(); ++j) {
    attribution[fmt::format("joint{}", j + 1)] = verdict.attribution[j];
    residual[fmt::format("joint{}", j + 1)] = verdict.residual_Nm[j];
  }
  return {{"file", verdict.file.string()},
          {"probability", verdict.probability},
          {"class", verdict.probability > 0.5 ? "faulty" : model.healthy},
          {"attribution", std::move(attribution)},
          {"healthy_probability", verdict.usual},
          {"residual_rmse_Nm", std::move(residual)},
          {"samples", verdict.samples},
          {"outside_training_share", verdict.outside_share},
          {"warnings", verdict.warnings}};
}

}  // namespace strainwave::bench
