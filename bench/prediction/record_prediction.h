// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "analysis/prediction/baseline.h"
#include "bench/prediction/operating_envelope.h"
#include "bench/prediction/predictor_file.h"
#include "bench/prediction/recipe_inputs.h"
#include "bench/prediction/record_features.h"

namespace strainwave::bench {

/// What all windows of a record say together: the mean of values and of half widths, the middle distance.
struct RecordPrediction {
  Eigen::RowVectorXd value;       // of each output; of classes their probabilities
  Eigen::RowVectorXd half_width;  // of the interval that holds `coverage` of records like those of training
  double distance{};              // from the training's features; beyond 1 it is outside of them
  Eigen::Index windows{};
  std::vector<std::string> left{};     // of training's torques, speeds and temperatures, in words
  std::vector<std::string> unknown{};  // of these, what is not known or contradicts itself

  bool outside() const { return distance > 1.0 || !left.empty(); }
};

/// A trained predictor for records; keeps its memory from record to record, one object a thread.
class RecordPredictor {
 public:
  /// @param folder  that `train` has written; @param baseline  file, of a predictor of changes; else empty.
  /// @throws BenchError as ReadPredictor and BaselineFor.
  RecordPredictor(const std::filesystem::path& folder, const std::filesystem::path& baseline);

  const Predictor& predictor() const { return predictor_; }
  /// How its records are to be read.
  MotorTorque motor_torque() const;

  /// @param given  under what the reducer ran, where the record does not tell it.
  /// @throws BenchError as RecipeInputs.
  RecordPrediction Predict(const daq::Record& record, const OperatingPoint& given = {});

 private:
  Predictor predictor_;
  RecipeInputs inputs_;
  std::optional<analysis::prediction::Baseline> baseline_;
};

}  // namespace strainwave::bench
