// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "bench/campaign/folder.h"
#include "bench/campaign/journal.h"
#include "bench/prediction/record_prediction.h"
#include "bench/serving/worker.h"

namespace strainwave::bench {

/// What a predictor says of one record of a cycle.
struct PredictedRecord {
  std::string group;  // of the record in its file
  RecordPrediction prediction;
};

/// `cycle`, `coverage`, `records`: of each `group`, `values` by quantity (value, low, high, measured with its
/// standard error or null, inside: whether the measured one lies in the interval or null) or, of classes,
/// `class` and `probabilities`; `windows`, `distance`, `outside_training`, `outside` in words, `warnings`.
/// @param measured  results of that cycle; of those that are not sound nothing is said.
nlohmann::json PredictionJson(int cycle, const Predictor& predictor,
                              const std::vector<PredictedRecord>& records,
                              const std::vector<Result>& measured);

/// Predicts from the vibration of complete cycles, in a thread of its own: what takes long keeps nobody
/// waiting. The newest answer is kept.
class CyclePredictor {
 public:
  /// Called from that thread, with a status of HTTP.
  using Done = std::function<void(int status, std::string json)>;

  /// @param predictor  folder that `strainwave train` has written; @param baseline  file; empty: none.
  /// @throws BenchError where they cannot be used.
  CyclePredictor(const CampaignFolder& folder, const std::filesystem::path& predictor,
                 const std::filesystem::path& baseline);

  /// @param cycle  0: the newest complete one. @return whether it will be answered: not where too many wait.
  bool Ask(int cycle, Done done);

 private:
  std::string Predict(int cycle);

  static constexpr std::size_t kMostWaiting = 16;

  const CampaignFolder folder_;
  RecordPredictor predictor_;
  std::pair<int, std::string> newest_;                 // cycle and answer
  Worker worker_{kMostWaiting, Worker::AtEnd::kDrop};  // its thread uses the above, and ends before
};

}  // namespace strainwave::bench
