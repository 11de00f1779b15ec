// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include <Eigen/Core>

#include "analysis/prediction/baseline.h"
#include "bench/prediction/feature_recipe.h"
#include "bench/prediction/onnx_network.h"
#include "bench/prediction/signal_inputs.h"

namespace strainwave::bench {

inline constexpr int kExportFormat = 2;
inline constexpr const char* kExportedRecipe = "recipe.json";

/// What the trained networks gave for some features, kept beside the exported one for its self-test.
struct GoldenVector {
  Eigen::RowVectorXd features;
  OnnxNetwork::Output expected;
};

/// What outputs are, and with it over what two of them are compared: values over themselves, changes, which
/// may be next to nothing, over the greater of themselves and their half width, probabilities as they are.
enum class OutputsAre { kValues, kChanges, kClasses };
OutputsAre WhatOutputsAre(const FeatureRecipe& recipe, OnnxNetwork::Predicts predicts);
Eigen::ArrayXd ComparedOver(OutputsAre what, const Eigen::RowVectorXd& value,
                            const Eigen::RowVectorXd& half_width);

/// Most that the exported network is off any golden vector: of prediction and half width over ComparedOver,
/// of the distance over the greater of 1 and the distance.
/// @throws std::invalid_argument for other sizes.
double WorstDisagreement(OnnxNetwork& network, std::span<const GoldenVector> golden,
                         OutputsAre what = OutputsAre::kValues);

/// Asked for of an exported network, over each output.
inline constexpr double kExportAgreement = 1e-5;

/// What one window of vibration says, in the outputs' units; of classes, their probabilities, without a
/// width.
struct PredictedOutputs {
  std::vector<double> value;
  std::vector<double> half_width;
  double distance{};                // above 1: outside what was trained on, nothing is promised
  std::vector<std::string> left{};  // of the torques, speeds and temperatures of the training, in words

  bool outside_training() const { return !(distance <= 1.0) || !left.empty(); }
};

/// A folder that `strainwave export` wrote, as a monitor runs it. One object a thread.
class ExportedPredictor {
 public:
  /// Reads the folder and tests it: hashes of all files, shapes, and the golden vectors through OpenCV.
  /// @throws BenchError naming the file, what is wrong with it and what was expected.
  explicit ExportedPredictor(const std::filesystem::path& folder);

  const FeatureRecipe& recipe() const { return parts_.recipe; }
  const std::vector<std::string>& outputs() const { return parts_.outputs; }
  bool classes() const { return parts_.predicts == OnnxNetwork::Predicts::kClasses; }
  double coverage() const { return parts_.coverage; }  // of the intervals

  /// What the predictor's changes are added to. @throws BenchError as `BaselineFor`; it must be called,
  /// with an empty path where there is no file, before the first prediction of a predictor that takes a
  /// baseline.
  void UseBaseline(const std::filesystem::path& file);

  double worst_disagreement() const { return worst_disagreement_; }

  /// @param signals  in any order, samples at `sample_rate_hz`.
  /// @param samples_per_turn  of the input shaft, where it is known; energies by order need it.
  /// @param operating  under what the reducer runs, as far as it is known.
  /// @return the outputs, or why there are none (signal_inputs.h). Signals that lie outside what was trained
  ///   on but would not if two channels were exchanged, count as swapped.
  std::variant<PredictedOutputs, SignalFault> Predict(std::span<const NamedSignal> signals,
                                                      double sample_rate_hz,
                                                      std::optional<double> samples_per_turn = {},
                                                      const OperatingPoint& operating = {});

 private:
  struct Parts {
    FeatureRecipe recipe;
    OnnxNetwork::Predicts predicts{OnnxNetwork::Predicts::kValues};
    std::vector<std::string> outputs;
    double coverage{};
    std::vector<GoldenVector> golden;
    std::string onnx;
  };
  static Parts Read(const std::filesystem::path& folder);
  /// Values from features, by way of their changes where there is a baseline.
  OnnxNetwork::Output RunSinceBaseline(const Eigen::RowVectorXd& features);

  std::filesystem::path folder_;
  Parts parts_;
  SignalInputs inputs_;
  OnnxNetwork network_;
  double worst_disagreement_{};
  Eigen::RowVectorXd features_;
  std::optional<analysis::prediction::Baseline> baseline_;
};

}  // namespace strainwave::bench
