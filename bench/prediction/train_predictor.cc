// SPDX-License-Identifier: Apache-2.0
#include "bench/prediction/train_predictor.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "bench/campaign/campaign_error.h"
#include "bench/campaign/on_all_processors.h"
#include "bench/prediction/network_json.h"

namespace strainwave::bench {
namespace {

namespace networks = analysis::networks;
namespace prediction = analysis::prediction;
using Json = nlohmann::ordered_json;

// The paper's filter looked at 500 records.
constexpr Eigen::Index kFilterRecords = 500;
constexpr int kPermutations = 5;

prediction::EnsembleSettings SettingsOf(const TrainingJob& job, int inputs, int outputs) {
  prediction::EnsembleSettings settings;
  settings.training.seed = job.seed;
  if (job.design == "small") {
    settings.design = {
        {1, inputs},
        {networks::Dense{64, networks::Activation::kTanh}, networks::Dense{32, networks::Activation::kTanh},
         networks::Dense{outputs, networks::Activation::kLinear}}};
    settings.training.loss = networks::Loss::kMse;
    settings.training.schedule = networks::CosineRate{.last = 0.02};
    settings.training.weight_decay = 1e-3;
    settings.training.epochs = 200;
    settings.training.early_stopping = networks::EarlyStopping{.patience = 40};
    settings.validation_share = 0.15;
    settings.members = 5;
  } else {
    try {
      settings.design = networks::DesignOf(job.design, inputs, outputs);
    } catch (const std::invalid_argument&) {
      throw CampaignError(
          ExitCode::kWrongInput,
          fmt::format("error: there is no design '{}' (expected small, ann or cnn)", job.design));
    }
  }
  if (job.epochs > 0) settings.training.epochs = job.epochs;
  if (job.members > 0) settings.members = job.members;
  (settings.members > 1 ? settings.parallel : settings.training.parallel) = OnAllProcessors;
  return settings;
}

// Rows spread evenly over all.
std::vector<Eigen::Index> Spread(Eigen::Index rows, Eigen::Index wanted) {
  const Eigen::Index count = std::min(rows, wanted);
  std::vector<Eigen::Index> chosen;
  for (Eigen::Index i = 0; i < count; ++i) chosen.push_back(i * rows / count);
  return chosen;
}

struct Filtered {
  prediction::Samples samples;
  FilterSummary summary;
};
Filtered Filter(const TrainingData& data, double limit) {
  const std::vector<Eigen::Index> looked_at = Spread(data.samples.size(), kFilterRecords);
  const auto columns = prediction::FilterCorrelated(data.samples.features(looked_at, Eigen::all), limit);
  FilterSummary summary{.records = looked_at.size(),
                        .vibration_features = data.vibration_features,
                        .torque_features = columns.size() - data.vibration_features};
  std::vector<Eigen::Index> kept;
  for (std::size_t i = 0; i < columns.size(); ++i) {
    if (!columns[i].kept) continue;
    const bool vibration = i < data.vibration_features;
    ++(vibration ? summary.vibration_kept : summary.torque_kept);
    if (vibration) kept.push_back(static_cast<Eigen::Index>(i));
  }
  return {prediction::Inputs(data.samples, kept), summary};
}

// All of one channel, and all of one level.
std::vector<prediction::InputGroup> GroupsOf(const std::vector<std::string>& inputs) {
  std::vector<prediction::InputGroup> groups;
  const auto add = [&groups](const std::string& name, Eigen::Index column) {
    auto found = std::ranges::find(groups, name, &prediction::InputGroup::name);
    if (found == groups.end()) found = groups.insert(groups.end(), {name, {}});
    found->columns.push_back(column);
  };
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    const std::size_t first = inputs[i].find('.');
    const std::size_t second = inputs[i].find('.', first + 1);
    add("channel " + inputs[i].substr(0, first), static_cast<Eigen::Index>(i));
    add("level " + inputs[i].substr(first + 1, second - first - 1), static_cast<Eigen::Index>(i));
  }
  return groups;
}

Json JsonOf(const std::vector<prediction::OutputScore>& scores, const std::vector<std::string>& outputs) {
  Json json;
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    json[outputs[i]] = {
        {"nmse", scores[i].nmse}, {"mape_percent", scores[i].mape_percent}, {"rmse", scores[i].rmse}};
  }
  json["mean_mape_percent"] = prediction::MeanMape_percent(scores);
  return json;
}

Json TrainingJson(const TrainingData& data, const TrainingJob& job,
                  const prediction::EnsembleSettings& settings, const TrainingOutcome& outcome) {
  Json sources = Json::array();
  for (const TrainingSource& source : data.sources) {
    sources.push_back(
        {{"folder", source.folder}, {"specimen", source.specimen}, {"records", source.records}});
  }
  Json splits = Json::array();
  for (const SplitResult& split : outcome.splits) {
    Json scores;
    for (const auto& contestant : split.contestants) {
      scores[contestant.name] = JsonOf(contestant.scores, data.samples.outputs);
    }
    splits.push_back({{"split", split.name},
                      {"meaning", split.meaning},
                      {"train", split.train},
                      {"test", split.test},
                      {"scores", std::move(scores)}});
  }
  Json importances = Json::array();
  for (const auto& importance : outcome.importances) {
    importances.push_back({{"inputs", importance.name},
                           {"mape_rise_percent", importance.mape_rise_percent},
                           {"se", importance.standard_error_percent}});
  }
  return {{"campaigns", std::move(sources)},
          {"data_sha256", data.sha256},
          {"records", data.samples.size()},
          {"design", job.design},
          {"epochs", settings.training.epochs},
          {"seed", job.seed},
          {"filter",
           {{"limit", job.correlation_limit},
            {"records", outcome.filter.records},
            {"vibration_features", outcome.filter.vibration_features},
            {"vibration_kept", outcome.filter.vibration_kept},
            {"torque_features", outcome.filter.torque_features},
            {"torque_kept", outcome.filter.torque_kept}}},
          {"splits", std::move(splits)},
          {"importance", std::move(importances)},
          {"notes", data.notes}};
}

struct NamedSplit {
  std::string name;
  std::string meaning;
  prediction::Split split;
};
std::vector<NamedSplit> SplitsOf(const prediction::Samples& samples, const TrainingJob& job) {
  std::vector<NamedSplit> splits{{"last part of each life", "a reducer that was watched before goes on",
                                  prediction::SplitByTime(samples.specimen, samples.cycle, job.test_share)}};
  if (prediction::SpecimenCount(samples) > 1) {
    splits.push_back({"unseen specimens", "a reducer that was never seen",
                      prediction::SplitsBySpecimen(samples.specimen, job.folds).front()});
  }
  splits.push_back({"random", "flatters: the neighbours in time of every tested record were trained on",
                    prediction::SplitAtRandom(samples.size(), job.test_share, job.seed)});
  return splits;
}

}  // namespace

TrainingOutcome TrainPredictor(const TrainingData& data, const analysis::features::WaveletRecipe& recipe,
                               const TrainingJob& job,
                               const std::function<bool(const std::string&, double)>& progress) {
  const Filtered filtered = Filter(data, job.correlation_limit);
  const prediction::Samples& samples = filtered.samples;
  const prediction::EnsembleSettings settings =
      SettingsOf(job, static_cast<int>(samples.inputs.size()), static_cast<int>(samples.outputs.size()));
  const std::vector<NamedSplit> splits = SplitsOf(samples, job);
  // Trainings as their measure: one a split, one a fold, and the last one.
  const double trainings = static_cast<double>(splits.size()) + job.folds + 1.0;

  std::vector<SplitResult> results;
  std::vector<prediction::Importance> importances;
  HeldOut held_out;
  for (std::size_t k = 0; k < splits.size(); ++k) {
    const NamedSplit& named = splits[k];
    const prediction::FitProgress step = [&](double share) {
      return progress("test on " + named.name, (static_cast<double>(k) + share) / trainings);
    };
    prediction::Comparison comparison = prediction::Compare(samples, named.split, settings, step);
    results.push_back({named.name, named.meaning, named.split.train.size(), named.split.test.size(),
                       std::move(comparison.contestants)});
    if (k > 0) continue;
    const prediction::Samples test = prediction::Rows(samples, named.split.test);
    const auto predict = [&](const Eigen::MatrixXd& features) {
      return comparison.network.Predict(features).mean;
    };
    importances = prediction::PermutationImportance(predict, test.features, test.targets,
                                                    GroupsOf(samples.inputs), kPermutations, job.seed);
    held_out = {test.cycle, test.specimen, test.targets, predict(test.features)};
  }
  const double before = static_cast<double>(splits.size()) / trainings;
  const prediction::FitProgress last = [&](double share) {
    return progress("predictor and its intervals", before + (1.0 - before) * share);
  };
  Predictor predictor{.recipe = {.wavelet = recipe,
                                 .channels = data.channels,
                                 .sample_rate_hz = data.sample_rate_hz,
                                 .least_samples = data.least_samples,
                                 .inputs = samples.inputs},
                      .outputs = samples.outputs,
                      .fitted = prediction::FitPredictor(samples, settings, job.coverage, job.folds, last),
                      .training_json = {}};
  TrainingOutcome outcome{std::move(predictor), filtered.summary, std::move(results), std::move(importances),
                          std::move(held_out)};
  outcome.predictor.training_json = TrainingJson(data, job, settings, outcome).dump();
  return outcome;
}

}  // namespace strainwave::bench
