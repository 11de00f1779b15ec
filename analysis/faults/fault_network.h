// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <string_view>
#include <vector>

#include "analysis/faults/fault_folds.h"
#include "analysis/parallel_for.h"
#include "analysis/prediction/fit_predictor.h"
#include "analysis/prediction/samples.h"

namespace strainwave::analysis::faults {

/// Which network is trained.
///   ours: tanh; softmax and cross-entropy over classes, a sigmoid and its squared error over labels; Adam
///     with a small weight decay; inputs of mean 0 and deviation 1; the mean of several networks.
///   study: docs/sources.md#jaber, Table 1: sigmoid, linear outputs, squared error, learning rate 0.05;
///   inputs
///     from 0 to 1; ends at an error of 1e-3, a gradient of 1e-4 or 50 000 epochs. (The study prints 10e-4
///     and 10e-5, and names no algorithm: here it is gradient descent with momentum 0.9 over all records.)
enum class FaultLine { kOurs, kStudy };

std::string_view NameOf(FaultLine line);
/// @throws std::invalid_argument for another name than ours and study.
FaultLine FaultLineOf(std::string_view name);

struct FaultNetworkSettings {
  FaultLine line{FaultLine::kOurs};
  bool labels{};  // each output by itself, in place of one class among all
  int hidden{17};
  int members{3};               // of ours
  int epochs{};                 // 0: 300 of ours, 50 000 of the study's at most
  double least_error{1e-3};     // of the study's
  double least_gradient{1e-4};  // of the study's
  std::uint64_t seed{1};
};

/// Errors over epochs, for the picture of a training.
struct FaultTrainingCourse {
  std::vector<int> epoch;
  std::vector<double> training;    // mean squared error of probabilities or outputs
  std::vector<double> validation;  // empty without records apart
  std::vector<double> test;
  std::string_view end;  // "error", "gradient", "epochs"
};

/// Trains on all samples.
/// @throws std::invalid_argument if a setting is out of range or samples do not fit together;
///   std::domain_error if a loss ceases to be finite.
prediction::Ensemble TrainFaultNetwork(const prediction::Samples& samples,
                                       const FaultNetworkSettings& settings);

/// What networks say of records that they have not seen.
struct FaultCrossFit {
  Eigen::MatrixXd probability;  // n × outputs; NaN where a record is in no test
  Eigen::VectorXd distance;     // over the limit of novelty; NaN likewise
};

/// A network a fold. `done` is told after each, from whatever thread; false ends the work with
/// prediction::TrainingEnded.
FaultCrossFit CrossFitFaults(const prediction::Samples& samples, const FaultFolds& folds,
                             const FaultNetworkSettings& settings, const ParallelFor& parallel,
                             const std::function<bool()>& done);

/// How far the distances of records that were not seen reach beyond the limits of their folds: what 99 % of
/// them keep, 1 at least.
double DistanceKeptOutside(const FaultCrossFit& cross);

/// On all samples, with what a cross-fit tells of its errors and of what lies outside.
prediction::FittedPredictor FitFaults(const prediction::Samples& samples,
                                      const FaultNetworkSettings& settings, const FaultCrossFit& cross);

/// The course of a training on 70 % of the records, beside 15 % and 15 % that it does not see.
FaultTrainingCourse CourseOfTraining(const prediction::Samples& samples,
                                     const FaultNetworkSettings& settings);

}  // namespace strainwave::analysis::faults
