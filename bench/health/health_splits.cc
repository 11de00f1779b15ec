// SPDX-License-Identifier: Apache-2.0
#include "bench/health/health_splits.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numeric>
#include <random>
#include <set>

#include <fmt/format.h>

#include "analysis/prediction/ridge.h"
#include "analysis/prediction/splits.h"
#include "analysis/shuffle.h"
#include "bench/campaign/on_all_processors.h"

namespace strainwave::bench {
namespace {

namespace networks = analysis::networks;
namespace prediction = analysis::prediction;

constexpr double kTestShare = 0.3;
constexpr int kMostConditionFolds = 16;
constexpr int kSearchFolds = 5;

struct NamedFolds {
  std::string name;
  std::string meaning;
  std::vector<prediction::Split> folds;
};

// Each fold's rows are those whose group is dealt to it.
std::vector<prediction::Split> FoldsOf(const std::vector<int>& group, int folds) {
  const std::set<int> groups(group.begin(), group.end());
  return prediction::SplitsBySpecimen(group, std::min(folds, static_cast<int>(groups.size())));
}

std::vector<prediction::Split> RandomFolds(Eigen::Index rows, int folds, std::uint64_t seed) {
  std::vector<int> fold(static_cast<std::size_t>(rows));
  for (std::size_t i = 0; i < fold.size(); ++i) fold[i] = static_cast<int>(i) % folds;
  std::mt19937_64 engine(seed);
  analysis::Shuffle(fold, engine);
  return FoldsOf(fold, folds);
}

std::vector<NamedFolds> SplitsOf(const HealthData& data, const HealthJob& job,
                                 std::vector<std::string>& notes) {
  std::vector<NamedFolds> all;
  const auto conditions = static_cast<int>(data.conditions.rows());
  all.push_back({"condition_left_out",
                 conditions > kMostConditionFolds
                     ? fmt::format("conditions never trained on, in {} folds", kMostConditionFolds)
                     : "each condition in turn, never trained on",
                 FoldsOf(data.condition, kMostConditionFolds)});
  if (data.units.size() > 1) {
    all.push_back(
        {"unit_left_out", "units (assemblies) never trained on", FoldsOf(data.samples.specimen, job.folds)});
  } else {
    notes.push_back("there is one unit: what another one would say is not known (unit_left_out)");
  }
  all.push_back({"random",
                 "cycles at random: it flatters, as neighbours of every tested cycle were trained on",
                 {prediction::SplitAtRandom(data.samples.size(), kTestShare, job.seed)}});
  return all;
}

// Folds without whose test a component no longer changes teach nothing of it.
void DropUntellable(const HealthData& data, NamedFolds& named, std::vector<std::string>& notes) {
  const std::size_t before = named.folds.size();
  std::erase_if(named.folds, [&](const prediction::Split& fold) {
    const Eigen::MatrixXd targets = data.samples.targets(fold.train, Eigen::all);
    return (targets.colwise().maxCoeff().array() == targets.colwise().minCoeff().array()).any();
  });
  if (named.folds.size() < before)
    notes.push_back(
        fmt::format("{}: {} of {} folds are not tested, since a component does not change in what is "
                    "left to train on",
                    named.name, before - named.folds.size(), before));
}

struct FoldResult {
  Eigen::MatrixXd predicted;
  Eigen::MatrixXd spread;
  Eigen::MatrixXd ridge;
  Eigen::MatrixXd mean;
};

FoldResult TestFold(const HealthData& data, const HealthJob& job, int hidden_nodes,
                    const prediction::Split& split) {
  const prediction::Samples seen = prediction::Rows(data.samples, split.train);
  const ChosenFeatures chosen = ChooseFeatures(seen, job);
  const prediction::Samples train = prediction::Inputs(seen, chosen.inputs);
  const Eigen::MatrixXd unseen = data.samples.features(split.test, chosen.inputs);
  const prediction::Ensemble ensemble = prediction::TrainEnsemble(
      train, NetworkOfHealth(job, train.features.cols(), train.targets.cols(), hidden_nodes, train.size()));
  prediction::Ensemble::Prediction predicted = ensemble.Predict(unseen);
  const prediction::Ridge ridge =
      prediction::FitRidge(ensemble.input.Apply(train.features), train.targets, train.specimen);
  return {std::move(predicted.mean), std::move(predicted.spread), ridge.Predict(ensemble.input.Apply(unseen)),
          train.targets.colwise().mean().replicate(unseen.rows(), 1)};
}

Eigen::RowVectorXd Rmse(const Eigen::MatrixXd& off) { return off.array().square().colwise().mean().sqrt(); }

}  // namespace

prediction::EnsembleSettings NetworkOfHealth(const HealthJob& job, Eigen::Index inputs, Eigen::Index outputs,
                                             int hidden_nodes, Eigen::Index rows) {
  prediction::EnsembleSettings settings;
  settings.design = {{1, static_cast<int>(inputs)},
                     {networks::Dense{hidden_nodes, networks::Activation::kTanh},
                      networks::Dense{static_cast<int>(outputs), networks::Activation::kLinear}}};
  settings.training.loss = networks::Loss::kMse;
  settings.training.optimizer = networks::ResilientPropagation{};
  settings.training.epochs = job.epochs;
  settings.training.batch = static_cast<int>(rows);
  settings.training.weight_decay = 1e-3;
  settings.training.seed = job.seed;
  settings.members = job.members;
  return settings;
}

std::vector<HealthSplit> TestHealth(const HealthData& data, const HealthJob& job, int hidden_nodes,
                                    const HealthProgress& progress, std::vector<std::string>& notes) {
  std::vector<NamedFolds> all = SplitsOf(data, job, notes);
  std::vector<HealthSplit> results;
  for (NamedFolds& named : all) {
    DropUntellable(data, named, notes);
    if (named.folds.empty()) continue;
    HealthSplit result{.name = named.name,
                       .meaning = named.meaning,
                       .rmse = {},
                       .ridge_rmse = {},
                       .mean_rmse = {},
                       .predicted = {},
                       .spread = {},
                       .rows = {}};
    std::vector<FoldResult> folds(named.folds.size());
    std::atomic<std::size_t> done{0};
    OnAllProcessors(named.folds.size(), [&](std::size_t k) {
      folds[k] = TestFold(data, job, hidden_nodes, named.folds[k]);
      const std::size_t count = ++done;
      progress("split " + named.name, static_cast<double>(count) / static_cast<double>(named.folds.size()));
    });
    for (const prediction::Split& fold : named.folds) {
      result.rows.insert(result.rows.end(), fold.test.begin(), fold.test.end());
      result.trained = std::max(result.trained, fold.train.size());
    }
    result.tested = result.rows.size();
    const auto n = static_cast<Eigen::Index>(result.tested);
    const Eigen::Index outputs = data.samples.targets.cols();
    result.predicted.resize(n, outputs);
    result.spread.resize(n, outputs);
    Eigen::MatrixXd ridge(n, outputs);
    Eigen::MatrixXd mean(n, outputs);
    Eigen::Index at = 0;
    for (const FoldResult& fold : folds) {
      const Eigen::Index rows = fold.predicted.rows();
      result.predicted.middleRows(at, rows) = fold.predicted;
      result.spread.middleRows(at, rows) = fold.spread;
      ridge.middleRows(at, rows) = fold.ridge;
      mean.middleRows(at, rows) = fold.mean;
      at += rows;
    }
    const Eigen::MatrixXd actual = data.samples.targets(result.rows, Eigen::all);
    result.rmse = Rmse(result.predicted - actual);
    result.ridge_rmse = Rmse(ridge - actual);
    result.mean_rmse = Rmse(mean - actual);
    results.push_back(std::move(result));
  }
  return results;
}

std::vector<HiddenTrial> SearchHiddenNodes(const HealthData& data, const ChosenFeatures& chosen,
                                           const HealthJob& job, const HealthProgress& progress) {
  std::vector<int> sizes{1, 2, 3, 4, 6, 8, 11, 15, 20, 27, 36, 50};
  if (job.every_node_count) {
    sizes.resize(50);
    std::iota(sizes.begin(), sizes.end(), 1);
  }
  const prediction::Samples samples = prediction::Inputs(data.samples, chosen.inputs);
  const bool by_unit = data.units.size() >= static_cast<std::size_t>(kSearchFolds);
  const std::vector<prediction::Split> folds =
      by_unit ? FoldsOf(samples.specimen, kSearchFolds) : RandomFolds(samples.size(), kSearchFolds, job.seed);
  std::vector<double> errors(sizes.size() * folds.size());
  std::atomic<std::size_t> done{0};
  // The largest networks first, so that no processor is left with one at the end.
  OnAllProcessors(errors.size(), [&](std::size_t task) {
    const std::size_t size = sizes.size() - 1 - task / folds.size();
    const prediction::Split& fold = folds[task % folds.size()];
    const prediction::Samples train = prediction::Rows(samples, fold.train);
    prediction::EnsembleSettings settings =
        NetworkOfHealth(job, train.features.cols(), train.targets.cols(), sizes[size], train.size());
    settings.members = 1;
    const prediction::Ensemble ensemble = prediction::TrainEnsemble(train, settings);
    const Eigen::MatrixXd off = ensemble.Predict(samples.features(fold.test, Eigen::all)).mean -
                                samples.targets(fold.test, Eigen::all);
    errors[size * folds.size() + task % folds.size()] = Rmse(off).mean();
    const std::size_t count = ++done;
    progress("number of hidden nodes", static_cast<double>(count) / static_cast<double>(errors.size()));
  });
  std::vector<HiddenTrial> trials;
  for (std::size_t s = 0; s < sizes.size(); ++s) {
    double sum = 0.0;
    for (std::size_t k = 0; k < folds.size(); ++k) sum += errors[s * folds.size() + k];
    trials.push_back({sizes[s], sum / static_cast<double>(folds.size())});
  }
  return trials;
}

}  // namespace strainwave::bench
