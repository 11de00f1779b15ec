// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "analysis/faults/fault_folds.h"
#include "analysis/faults/fault_network.h"
#include "analysis/faults/fault_scores.h"
#include "bench/faults/fault_features.h"
#include "bench/faults/fault_model.h"

namespace strainwave::bench {

enum class FaultFeatures { kBetter, kDetails, kEnvelopeOrders };

struct FaultJob {
  analysis::faults::FaultNetworkSettings network;
  analysis::faults::UndecidedRule rule;
  FaultFeatures features{FaultFeatures::kBetter};  // of two the one that did better on honest splits
  std::optional<analysis::RollingBearing> bearing{};
  bool compare{};  // levels that are kept, and wavelets
};

/// A way to leave records out, and which.
struct FaultSplit {
  std::string name;     // "random", "unit_left_out", a column, "pairs_left_out"
  std::string meaning;  // what it tells, in words
  bool honest{};        // whole groups are left out
  analysis::faults::FaultFolds folds;
  std::string limit;  // why there is none, or which records it cannot test; empty else
};

/// How a set of features did on one split; neither scores where nothing could be tested.
struct FaultSplitResult {
  std::optional<analysis::faults::ClassScores> classes;
  std::optional<analysis::faults::LabelScores> labels;

  /// Share told right: of classes, or of records all of whose labels are right.
  std::optional<double> Accuracy() const;
  std::size_t Tested() const;
};

struct FaultTableResult {
  FeatureSet set{};
  std::vector<FaultSplitResult> splits;  // as `FaultOutcome::splits`
  double honest{};  // mean accuracy over the honest splits, over the random one where there is none
};

struct FaultOutcome {
  std::vector<FaultSplit> splits;
  std::vector<FaultTableResult> tables;  // one a set of features
  std::size_t chosen{};                  // of these
  /// Of details D1 to D1, to D2 and on, and by other wavelets, where they were compared.
  std::vector<FaultTableResult> by_levels{};
  std::vector<std::pair<std::string, FaultTableResult>> by_wavelet{};
  std::vector<std::string> limits;
  analysis::faults::FaultTrainingCourse course;
  Eigen::MatrixXd left_out;  // probabilities of each record by what had not seen its split, for the picture
  std::string left_out_by;   // the split
  FaultModel model;
};

/// Told step and share of all; false ends the training with prediction::TrainingEnded.
using FaultTrainingProgress = std::function<bool(const std::string& step, double share)>;

/// The folds of each split: at random, by unit, by each column to split by, and of labels from singles to
/// records of several.
std::vector<FaultSplit> FaultSplitsOf(const FaultLabels& labels, std::uint64_t seed);

/// What networks trained on the table are worth on each split.
FaultTableResult TestFaultTable(const FaultRecords& records, const FaultTable& table,
                                const std::vector<FaultSplit>& splits, const FaultJob& job,
                                const std::function<bool()>& done);

/// Tests each set of features on each split, takes the better one, and trains the model on all records.
/// @throws BenchError if the set that is asked for is not there.
FaultOutcome TrainFaults(const std::filesystem::path& folder, const FaultRecords& records,
                         const FaultJob& job, const FaultTrainingProgress& progress);

}  // namespace strainwave::bench
