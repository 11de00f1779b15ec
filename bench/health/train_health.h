// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "analysis/health/component_scores.h"
#include "analysis/health/feature_selection.h"
#include "analysis/prediction/fit_predictor.h"
#include "bench/health/health_data.h"
#include "bench/health/system_model.h"
#include "bench/prediction/predictor_file.h"

namespace strainwave::bench {

struct HealthJob {
  analysis::health::ScoreSettings scores;
  analysis::health::SelectionSettings selection{.least = 3};
  int hidden_nodes{};       // 0: searched for
  bool every_node_count{};  // search all of 1 to 50 in place of twelve of them
  int epochs{300};
  int members{3};
  int folds{10};  // of units
  double coverage{0.9};
  std::uint64_t seed{1};
  SystemSettings system;
};

/// The features that tell each component, and all of them together, which are the network's inputs.
struct ChosenFeatures {
  std::vector<analysis::health::ComponentScores> scores;
  std::vector<analysis::health::Selection> of_component;
  std::vector<Eigen::Index> inputs;
};
/// @throws BenchError if no feature tells anything.
ChosenFeatures ChooseFeatures(const analysis::prediction::Samples& samples, const HealthJob& job);

/// How a split did on cycles that its training had not seen: root mean square errors, one a component.
struct HealthSplit {
  std::string name;  // "random", "condition_left_out", "unit_left_out"
  std::string meaning;
  std::size_t trained{};
  std::size_t tested{};
  Eigen::RowVectorXd rmse;
  Eigen::RowVectorXd ridge_rmse;
  Eigen::RowVectorXd mean_rmse;  // of always saying the mean of the training
  Eigen::MatrixXd predicted;     // of `rows`
  Eigen::MatrixXd spread;        // of the members
  std::vector<Eigen::Index> rows;
};

struct HiddenTrial {
  int nodes{};
  double rmse{};  // mean over components and folds
};

struct HealthOutcome {
  ChosenFeatures chosen;
  std::vector<HiddenTrial> trials;  // none where the number was given
  int hidden_nodes{};
  std::vector<HealthSplit> splits;
  SystemVariance variance;
  std::optional<SystemModel> system;
  std::optional<Predictor> predictor;
  std::vector<std::string> notes;
};

/// Selects features, finds the number of hidden nodes, and trains. In each split features are selected from
/// the training part alone; the number of nodes is one for all.
/// @throws BenchError where the data cannot teach.
HealthOutcome TrainHealth(const HealthData& data, const HealthJob& job, const HealthProgress& progress);

}  // namespace strainwave::bench
