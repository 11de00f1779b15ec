// SPDX-License-Identifier: Apache-2.0
#include "bench/prediction/train_predictor.h"

#include <algorithm>
#include <map>
#include <utility>

#include <fmt/format.h>

#include "analysis/prediction/baseline.h"
#include "bench/campaign/on_all_processors.h"
#include "bench/errors/bench_error.h"
#include "bench/prediction/training_json.h"

namespace strainwave::bench {
namespace {

namespace networks = analysis::networks;
namespace prediction = analysis::prediction;

// The filter of docs/sources.md#shivam-2023 looked at 500 records.
constexpr Eigen::Index kFilterRecords = 500;
constexpr int kPermutations = 5;
constexpr const char* kUnseen = "unseen specimens";

prediction::EnsembleSettings SettingsOf(const TrainingJob& job, const prediction::Samples& samples) {
  const auto inputs = static_cast<int>(samples.inputs.size());
  const auto outputs = static_cast<int>(samples.outputs.size());
  prediction::EnsembleSettings settings;
  settings.training.seed = job.seed;
  if (job.design == "small") {
    settings.design = prediction::Candidate{.widths = {64, 32}}.DesignFor(inputs, outputs);
    settings.training.loss = networks::Loss::kMse;
    settings.training.schedule = networks::CosineRate{.last = 0.02};
    settings.training.weight_decay = 1e-3;
    settings.training.epochs = 200;
    settings.training.early_stopping = networks::EarlyStopping{.patience = 40};
    settings.validation_share = 0.15;
    settings.members = 5;
    settings.beside_line = !samples.classes;
  } else {
    try {
      settings.design = networks::DesignOf(job.design, inputs, outputs);
    } catch (const std::invalid_argument& error) {
      if (job.design == "ann" || job.design == "cnn") {
        throw BenchError(
            ExitCode::kWrongInput,
            fmt::format("error: the design {} does not fit {} inputs: {} (expected more of them, "
                        "or --design small)",
                        job.design, inputs, error.what()));
      }
      throw BenchError(
          ExitCode::kWrongInput,
          fmt::format("error: there is no design '{}' (expected small, ann or cnn)", job.design));
    }
  }
  // A change passes through zero, of which nothing is a percentage.
  if (job.baseline_records > 0) settings.training.loss = networks::Loss::kMse;
  if (samples.classes) settings.training.loss = networks::Loss::kCrossEntropy;
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
Filtered Filter(const prediction::Samples& samples, std::size_t vibration_features, double limit) {
  const std::vector<Eigen::Index> looked_at = Spread(samples.size(), kFilterRecords);
  const auto columns = prediction::FilterCorrelated(samples.features(looked_at, Eigen::all), limit);
  FilterSummary summary{.records = looked_at.size(),
                        .vibration_features = vibration_features,
                        .torque_features = columns.size() - vibration_features};
  std::vector<Eigen::Index> kept;
  for (std::size_t i = 0; i < columns.size(); ++i) {
    if (!columns[i].kept) continue;
    const bool vibration = i < vibration_features;
    ++(vibration ? summary.vibration_kept : summary.torque_kept);
    if (vibration) kept.push_back(static_cast<Eigen::Index>(i));
  }
  return {prediction::Inputs(samples, kept), summary};
}

prediction::Samples ChangesOf(const TrainingData& data, int baseline_records) {
  try {
    prediction::Samples changes = prediction::SinceBaseline(data.samples, baseline_records);
    if (changes.size() >= static_cast<Eigen::Index>(kFewestRows)) return changes;
    throw std::invalid_argument(
        fmt::format("{} records remain (expected at least {})", changes.size(), kFewestRows));
  } catch (const std::invalid_argument& error) {
    throw BenchError(ExitCode::kWrongInput,
                     fmt::format("error: baseline of {} records: {}", baseline_records, error.what()));
  }
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

struct NamedSplit {
  std::string name;
  std::string meaning;
  prediction::Split split;
  bool honest{true};
};

// Whether what is predicted changes within a specimen: where it does not, telling known specimens apart is
// enough.
bool ChangesWithinSpecimens(const prediction::Samples& samples) {
  std::map<int, Eigen::Index> first;
  for (Eigen::Index row = 0; row < samples.size(); ++row) {
    const auto seen = first.try_emplace(samples.specimen[static_cast<std::size_t>(row)], row).first;
    if (samples.targets.row(row) != samples.targets.row(seen->second)) return true;
  }
  return false;
}

// Whether each specimen has a later part that is worth the name.
bool HasLives(const prediction::Samples& samples, double test_share) {
  const double rows = static_cast<double>(samples.size()) / prediction::SpecimenCount(samples);
  return rows * test_share >= 1.0;
}

// Those that do not flatter first.
std::vector<NamedSplit> SplitsOf(const prediction::Samples& samples, const std::string& specimens_taken_for,
                                 const TrainingJob& job) {
  std::vector<NamedSplit> splits;
  if (HasLives(samples, job.test_share)) {
    splits.push_back({"last part of each life", "a reducer that was watched before goes on",
                      prediction::SplitByTime(samples.specimen, samples.cycle, job.test_share)});
  }
  if (prediction::SpecimenCount(samples) > 1) {
    if (!splits.empty() && !ChangesWithinSpecimens(samples)) {
      splits.back().meaning =
          "flatters: what was measured is one and the same in each specimen, so that to know it again is "
          "enough";
      splits.back().honest = false;
    }
    splits.push_back(
        {kUnseen,
         "a reducer that was never seen" +
             (specimens_taken_for.empty() ? "" : ", if each " + specimens_taken_for + " is of another"),
         prediction::SplitsBySpecimen(samples.specimen, job.folds).front()});
    std::ranges::stable_partition(splits, &NamedSplit::honest);
  }
  splits.push_back({"random", "flatters: the neighbours in time of every tested record were trained on",
                    prediction::SplitAtRandom(samples.size(), job.test_share, job.seed), false});
  return splits;
}

// Adds up the work of steps that take each a number of trainings.
class Steps {
 public:
  Steps(double trainings, const TrainingProgressSink& sink) : trainings_(trainings), sink_(sink) {}

  prediction::FitProgress Next(std::string name, double trainings) {
    const double begin = done_;
    done_ += trainings;
    return [this, name = std::move(name), begin, trainings](double share) {
      return sink_(name, (begin + share * trainings) / trainings_);
    };
  }

 private:
  double trainings_;
  double done_{};
  const TrainingProgressSink& sink_;
};

// The winner's design and decay go into the settings. The records of the first split's test stay unseen.
std::vector<prediction::Trial> Search(const prediction::Samples& samples, const prediction::Split& split,
                                      const TrainingJob& job, prediction::EnsembleSettings& settings,
                                      const prediction::FitProgress& progress) {
  const prediction::Samples seen = prediction::Rows(samples, split.train);
  prediction::EnsembleSettings spread = settings;
  spread.parallel = OnAllProcessors;
  std::vector<prediction::Trial> trials = prediction::SearchDesigns(
      seen, prediction::UsualCandidates(), prediction::HonestFolds(seen, job.folds), spread, progress);
  const prediction::Candidate& winner = trials.front().candidate;
  settings.design =
      winner.DesignFor(static_cast<int>(samples.inputs.size()), static_cast<int>(samples.outputs.size()));
  settings.training.weight_decay = winner.weight_decay;
  return trials;
}

}  // namespace

TrainingOutcome TrainPredictor(const TrainingData& data, const TrainingJob& job,
                               const TrainingProgressSink& progress) {
  const Filtered filtered =
      Filter(job.baseline_records > 0 ? ChangesOf(data, job.baseline_records) : data.samples,
             data.vibration_features, job.correlation_limit);
  const prediction::Samples& samples = filtered.samples;
  prediction::EnsembleSettings settings = SettingsOf(job, samples);
  std::vector<NamedSplit> splits = SplitsOf(samples, data.specimens_taken_for, job);
  if (job.compare_only) std::erase_if(splits, [](const NamedSplit& split) { return !split.honest; });
  const double fit_trainings = job.compare_only ? 0.0 : job.folds + 1.0;
  constexpr double kSearch = 3.0;
  constexpr double kCurve = 2.0;
  Steps steps((job.search ? kSearch : 0.0) + (job.learning_curve ? kCurve : 0.0) +
                  static_cast<double>(splits.size()) + fit_trainings,
              progress);
  TrainingOutcome outcome;
  outcome.filter = filtered.summary;
  if (job.search) {
    outcome.trials = Search(samples, splits.front().split, job, settings, steps.Next("search", kSearch));
  }
  for (std::size_t k = 0; k < splits.size(); ++k) {
    const NamedSplit& named = splits[k];
    prediction::Comparison comparison =
        prediction::Compare(samples, named.split, settings, steps.Next("test on " + named.name, 1.0));
    outcome.splits.push_back({named.name, named.meaning, named.split.train.size(), named.split.test.size(),
                              std::move(comparison.contestants)});
    if (!named.honest) continue;
    const prediction::Samples test = prediction::Rows(samples, named.split.test);
    const auto predict = [&](const Eigen::MatrixXd& features) {
      return comparison.network.Predict(features).mean;
    };
    if (job.compare_only || named.name != kUnseen) {
      outcome.worth.push_back({named.name, prediction::WorthOf(samples, GroupsOfTest(samples, named.split),
                                                               predict(samples.features))});
    }
    outcome.held_out.push_back({named.name, test.cycle, prediction::Values(test, test.targets),
                                prediction::Values(test, predict(test.features))});
    if (k > 0) continue;
    const auto error_percent = [&](const Eigen::MatrixXd& features) {
      return prediction::Judge("", test, predict(features)).Error_percent();
    };
    outcome.importances = prediction::PermutationImportance(
        error_percent, test.features, GroupsOf(samples.inputs), kPermutations, job.seed);
  }
  if (job.learning_curve) {
    prediction::EnsembleSettings spread = settings;
    spread.parallel = OnAllProcessors;
    outcome.curve = prediction::LearningCurve(samples, splits.front().split, spread,
                                              steps.Next("learning curve", kCurve));
  }
  if (job.compare_only) {
    outcome.report_json = TrainingJson(data, job, settings, outcome);
    return outcome;
  }
  prediction::Fit fit = prediction::FitPredictor(samples, settings, job.coverage, job.folds,
                                                 steps.Next("predictor and its folds", fit_trainings));
  outcome.folds = {prediction::SpecimenCount(samples) > 1 ? "whole specimens" : "blocks of time",
                   prediction::FoldErrors_percent(samples, fit.folds, fit.cross),
                   prediction::CompareFolds(samples, fit.folds, fit.cross), fit.left_out_coverage};
  if (prediction::SpecimenCount(samples) > 1) {
    // All specimens left out in turn tell more of this use than those of one split.
    const auto unseen = std::ranges::find(outcome.splits, kUnseen, &SplitResult::name);
    unseen->meaning += "; each left out in turn";
    unseen->test = static_cast<std::size_t>(samples.size());
    unseen->contestants = outcome.folds.contestants;
    outcome.worth.push_back({kUnseen, prediction::WorthOf(samples, fit.folds, fit.cross.predicted)});
  }
  FeatureRecipe recipe = data.recipe;
  recipe.inputs = samples.inputs;
  recipe.baseline_records = job.baseline_records;
  outcome.report_json = TrainingJson(data, job, settings, outcome);
  outcome.predictor.emplace(
      Predictor{std::move(recipe), samples.outputs, std::move(fit.predictor), outcome.report_json});
  return outcome;
}

}  // namespace strainwave::bench
