// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include <string>
#include <vector>

namespace strainwave::analysis::prediction {

/// What a predictor learns from: one row a record, all finite. Where it learns classes, an output is a class,
/// and its target is 1 for a record of that class and 0 for any other.
struct Samples {
  Eigen::MatrixXd features;   // n × inputs
  Eigen::MatrixXd targets;    // n × outputs
  std::vector<int> specimen;  // n; rows of one number are of one reducer
  std::vector<double> cycle;  // n; how far each reducer was in its life
  std::vector<std::string> inputs;
  std::vector<std::string> outputs;
  bool classes{};
  /// n × outputs where targets are changes since each reducer's baseline (`baseline.h`): what they are
  /// changes from. Empty where they are values.
  Eigen::MatrixXd origin{};

  Eigen::Index size() const noexcept { return features.rows(); }
};

/// How many reducers the rows are of.
int SpecimenCount(const Samples& samples);

/// Targets or predictions of all rows as values in the outputs' units.
Eigen::MatrixXd Values(const Samples& samples, const Eigen::MatrixXd& targets);

/// The rows of `samples` that are named, in that order.
Samples Rows(const Samples& samples, const std::vector<Eigen::Index>& rows);

/// The inputs of `samples` that are named, in that order.
Samples Inputs(const Samples& samples, const std::vector<Eigen::Index>& columns);

/// @throws std::invalid_argument if the parts have different lengths or a value is not finite; names it.
void Check(const Samples& samples);

}  // namespace strainwave::analysis::prediction
