// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "analysis/prediction/correlation_filter.h"
#include "analysis/prediction/design_search.h"
#include "analysis/prediction/importance.h"
#include "analysis/prediction/learning_curve.h"
#include "bench/prediction/network_worth.h"
#include "bench/prediction/predictor_file.h"
#include "bench/prediction/training_data.h"

namespace strainwave::bench {

/// How a predictor is to be trained.
struct TrainingJob {
  /// `small`: two dense layers, squared loss, early stopping, five members, beside a line. `ann`, `cnn`: of
  /// docs/sources.md#shivam-2023, section V: percentage loss, Adam, 1000 epochs in batches of 32, alone.
  std::string design{"small"};
  int epochs{};   // 0: as the design says
  int members{};  // 0: as the design says
  int folds{5};
  double coverage{0.9};
  double correlation_limit{0.75};
  double test_share{1000.0 / 3500.0};  // of each life, the last part
  int baseline_records{};  // of each reducer's first, since which changes are predicted; 0: values are
  std::uint64_t seed{1};
  bool search{};          // for widths, depth and decay of a small network
  bool learning_curve{};  // how few records would do
  bool compare_only{};    // on the honest splits; no predictor is fitted, which takes most of the time
};

/// What the correlation filter left of the features.
struct FilterSummary {
  std::size_t records{};  // that it looked at
  std::size_t vibration_features{};
  std::size_t vibration_kept{};
  std::size_t torque_features{};
  std::size_t torque_kept{};  // said nothing that vibration says; not used all the same
};

/// The comparison on one split.
struct SplitResult {
  std::string name;     // "last part of each life", "unseen specimens", "random"
  std::string meaning;  // what it tells, in words
  std::size_t train{};
  std::size_t test{};
  std::vector<analysis::prediction::Contestant> contestants;
};

/// Predictions of a split's test by a network that had not seen it, for the picture.
struct HeldOut {
  std::string split;
  std::vector<double> cycle;
  Eigen::MatrixXd actual;
  Eigen::MatrixXd predicted;
};

/// Every record predicted once, by what had not seen its fold.
struct FoldResult {
  std::string of;                                             // "whole specimens", or "blocks of time"
  std::vector<double> error_percent;                          // of each fold
  std::vector<analysis::prediction::Contestant> contestants;  // the network first
  /// Share of the records, one an output, inside intervals calibrated on the other folds; empty for classes.
  Eigen::RowVectorXd interval_coverage;
};

struct TrainingOutcome {
  FilterSummary filter;
  std::vector<analysis::prediction::Trial> trials;  // of the search, the winner first
  std::vector<SplitResult> splits;
  std::vector<analysis::prediction::Importance> importances;
  std::vector<HeldOut> held_out;  // of the honest splits
  std::vector<analysis::prediction::LearningPoint> curve;
  FoldResult folds;
  std::vector<UseWorth> worth;         // in each use that the honest splits are like
  std::optional<Predictor> predictor;  // none, and no folds, where the job was to compare
  std::string report_json;             // an object: from what it was trained, how, and how well it did
};

/// Told step and share of all; false ends the training.
using TrainingProgressSink = std::function<bool(const std::string& step, double share)>;

/// Filters the features, searches a design if asked to, compares the network with what it has to beat on
/// honest splits and on a random one, fits the predictor on everything, and measures what its inputs are
/// worth.
/// @throws BenchError for a design without that name, or too few records beside a baseline;
/// prediction::TrainingEnded when progress ended it.
TrainingOutcome TrainPredictor(const TrainingData& data, const TrainingJob& job,
                               const TrainingProgressSink& progress);

}  // namespace strainwave::bench
