// SPDX-License-Identifier: Apache-2.0
#include "bench/health/train_health.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "analysis/health/levels.h"
#include "analysis/prediction/novelty.h"
#include "bench/campaign/on_all_processors.h"
#include "bench/errors/bench_error.h"
#include "bench/health/health_json.h"
#include "bench/health/health_splits.h"
#include "bench/health/motor_records.h"

namespace strainwave::bench {
namespace {

namespace health = analysis::health;
namespace prediction = analysis::prediction;

constexpr Eigen::Index kFewestCycles = 12;
constexpr double kInsideShare = 0.99;  // of unseen cycles that are called known

// Coarser levels of the other components, down to one, until the component has two levels within some cell.
health::ComponentScores ScoresOf(const prediction::Samples& samples, Eigen::Index component,
                                 const health::ScoreSettings& settings) {
  for (const int most : {health::kMostLevels, 4, 2}) {
    const Eigen::MatrixXi levels = health::LevelsOf(samples.targets, most);
    health::ComponentScores scores =
        health::ScoreFeatures(samples.features, samples.targets, levels, component, settings);
    if (scores.cells > 0) return scores;
  }
  Eigen::MatrixXi levels = Eigen::MatrixXi::Zero(samples.targets.rows(), samples.targets.cols());
  levels.col(component) = health::LevelsOf(samples.targets.col(component), health::kMostLevels);
  return health::ScoreFeatures(samples.features, samples.targets, levels, component, settings);
}

const HealthSplit* SplitOf(const HealthOutcome& outcome, std::string_view name) {
  const auto found = std::ranges::find(outcome.splits, name, &HealthSplit::name);
  return found == outcome.splits.end() ? nullptr : &*found;
}

// Intervals from the errors on units and on conditions that were left out: a robot's health is seldom one of
// the levels that were trained.
void Calibrate(const HealthData& data, const HealthJob& job, const HealthOutcome& outcome,
               prediction::FittedPredictor& fitted) {
  const Eigen::Index outputs = data.samples.targets.cols();
  std::vector<const HealthSplit*> honest;
  for (const char* name : {"unit_left_out", "condition_left_out"}) {
    if (const HealthSplit* split = SplitOf(outcome, name)) honest.push_back(split);
  }
  HealthSplit trained{.name = "",
                      .meaning = "",
                      .rmse = {},
                      .ridge_rmse = {},
                      .mean_rmse = {},
                      .predicted = {},
                      .spread = {},
                      .rows = {}};
  if (honest.empty()) {
    // Nothing could be left out: what it was trained on, which flatters.
    prediction::Ensemble::Prediction own =
        fitted.ensemble.Predict(data.samples.features(Eigen::all, outcome.chosen.inputs));
    trained.predicted = std::move(own.mean);
    trained.spread = std::move(own.spread);
    for (Eigen::Index row = 0; row < data.samples.size(); ++row) trained.rows.push_back(row);
    const HealthSplit* random = SplitOf(outcome, "random");
    honest.push_back(random != nullptr ? random : &trained);
  }
  Eigen::Index rows = 0;
  for (const HealthSplit* split : honest) rows += split->predicted.rows();
  Eigen::MatrixXd actual(rows, outputs);
  Eigen::MatrixXd predicted(rows, outputs);
  Eigen::MatrixXd spread(rows, outputs);
  std::vector<int> group;
  Eigen::Index at = 0;
  int offset = 0;
  for (const HealthSplit* split : honest) {
    const bool units = split->name == "unit_left_out";
    const Eigen::Index count = split->predicted.rows();
    actual.middleRows(at, count) = data.samples.targets(split->rows, Eigen::all);
    predicted.middleRows(at, count) = split->predicted;
    spread.middleRows(at, count) = split->spread;
    for (const Eigen::Index row : split->rows) {
      const auto place = static_cast<std::size_t>(row);
      group.push_back(offset + (units ? data.samples.specimen[place] : data.condition[place]));
    }
    at += count;
    offset += static_cast<int>(data.units.size());
  }
  fitted.residual = (actual - predicted).array().square().colwise().mean().sqrt().max(1e-300);
  const Eigen::MatrixXd widths =
      (spread.array().square().rowwise() + fitted.residual.array().square()).sqrt();
  fitted.band = prediction::CalibrateBand(actual, predicted, widths, group, job.coverage);
}

// The limit by units (or cycles) that the covariance had not seen.
prediction::Novelty NoveltyOf(const HealthData& data, const prediction::FittedPredictor& fitted,
                              const prediction::Samples& samples, const HealthOutcome& outcome) {
  const Eigen::MatrixXd inputs = fitted.ensemble.input.Apply(samples.features);
  prediction::Novelty novelty = prediction::FitNovelty(inputs, inputs, kInsideShare);
  if (data.units.size() < 2 || SplitOf(outcome, "unit_left_out") == nullptr) return novelty;
  Eigen::VectorXd distance = Eigen::VectorXd::Zero(inputs.rows());
  for (const prediction::Split& fold : prediction::SplitsBySpecimen(samples.specimen, 10)) {
    const Eigen::MatrixXd seen = inputs(fold.train, Eigen::all);
    if (seen.rows() < 3) return novelty;
    const Eigen::VectorXd away =
        prediction::FitNovelty(seen, seen, kInsideShare).Distance(inputs(fold.test, Eigen::all));
    distance(fold.test) = away;
  }
  novelty.limit = std::max(novelty.limit, prediction::DistanceKept(distance, kInsideShare));
  return novelty;
}

FeatureRecipe RecipeOf(const HealthData& data, const prediction::Samples& samples) {
  FeatureRecipe recipe;
  recipe.features.set = FeatureSet::kPackets;
  recipe.features.packets = data.recipe;
  recipe.channels = kMotorChannels;
  recipe.sample_rate_hz = data.sample_rate_hz;
  // A stream has no cycles: windows of as many samples as one, wherever they begin.
  recipe.window.samples = data.shortest;
  recipe.least_samples = data.shortest;
  recipe.inputs = samples.inputs;
  return recipe;
}

}  // namespace

ChosenFeatures ChooseFeatures(const prediction::Samples& samples, const HealthJob& job) {
  ChosenFeatures chosen;
  for (Eigen::Index c = 0; c < samples.targets.cols(); ++c) {
    chosen.scores.push_back(ScoresOf(samples, c, job.scores));
    chosen.of_component.push_back(
        health::SelectFeatures(samples.features, chosen.scores.back().score, job.selection));
    for (const Eigen::Index feature : chosen.of_component.back().kept) {
      if (std::ranges::find(chosen.inputs, feature) == chosen.inputs.end()) chosen.inputs.push_back(feature);
    }
  }
  if (chosen.inputs.empty())
    throw BenchError(
        ExitCode::kWrongInput,
        fmt::format("error: none of {} features changes with the health of any component (expected "
                    "records that differ)",
                    samples.features.cols()));
  return chosen;
}

HealthOutcome TrainHealth(const HealthData& data, const HealthJob& job, const HealthProgress& progress) {
  if (data.samples.size() < kFewestCycles)
    Refuse(data.folder / "labels.csv", fmt::format("{} cycles", data.samples.size()),
           fmt::format("{} or more", kFewestCycles));
  HealthOutcome outcome;
  outcome.notes = data.notes;
  const auto part = [&progress](double begin, double end) {
    return [&progress, begin, end](const std::string& step, double share) {
      progress(step, begin + (end - begin) * share);
    };
  };
  outcome.chosen = ChooseFeatures(data.samples, job);
  for (std::size_t c = 0; c < data.components.size(); ++c) {
    if (outcome.chosen.of_component[c].kept.empty())
      outcome.notes.push_back(fmt::format("no feature tells {}", data.components[c]));
  }
  outcome.hidden_nodes = job.hidden_nodes;
  if (job.hidden_nodes == 0) {
    outcome.trials = SearchHiddenNodes(data, outcome.chosen, job, part(0.0, 0.4));
    double least = outcome.trials.front().rmse;
    for (const HiddenTrial& trial : outcome.trials) least = std::min(least, trial.rmse);
    // Those as good as the best to a hundredth are ties: the smallest network of them.
    constexpr double kTie = 1.01;
    outcome.hidden_nodes = std::ranges::find_if(outcome.trials, [&](const HiddenTrial& t) {
                             return t.rmse <= kTie * least;
                           })->nodes;
  }
  outcome.splits = TestHealth(data, job, outcome.hidden_nodes, part(0.4, 0.9), outcome.notes);
  const prediction::Samples samples = prediction::Inputs(data.samples, outcome.chosen.inputs);
  prediction::EnsembleSettings settings = NetworkOfHealth(
      job, samples.features.cols(), samples.targets.cols(), outcome.hidden_nodes, samples.size());
  settings.parallel = OnAllProcessors;
  prediction::FittedPredictor fitted{.ensemble = prediction::TrainEnsemble(samples, settings),
                                     .residual = {},
                                     .band = {},
                                     .novelty = {},
                                     .least = samples.features.colwise().minCoeff(),
                                     .greatest = samples.features.colwise().maxCoeff()};
  Calibrate(data, job, outcome, fitted);
  fitted.novelty = NoveltyOf(data, fitted, samples, outcome);
  progress("system", 0.95);
  outcome.variance = VarianceOfSystem(data, outcome.notes);
  outcome.system = FitSystem(data, job.system, outcome.notes);
  outcome.predictor.emplace(Predictor{RecipeOf(data, samples), data.components, std::move(fitted), {}});
  outcome.predictor->training_json = TrainingJsonOf(data, job, outcome).dump();
  return outcome;
}

}  // namespace strainwave::bench
