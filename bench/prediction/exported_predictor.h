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
#include "bench/prediction/exported_model.h"
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

/// A folder that `strainwave export` wrote, as a monitor runs it. One object a thread.
class ExportedPredictor final : public ExportedModel {
 public:
  /// Reads the folder and tests it: hashes of all files, shapes, and the golden vectors through OpenCV.
  /// @throws BenchError naming the file, what is wrong with it and what was expected.
  explicit ExportedPredictor(const std::filesystem::path& folder);

  const FeatureRecipe& recipe() const { return parts_.recipe; }
  SignalNeeds needs() const override;
  const std::vector<std::string>& outputs() const override { return parts_.outputs; }
  bool classes() const override { return parts_.predicts == OnnxNetwork::Predicts::kClasses; }
  double coverage() const override { return parts_.coverage; }
  std::vector<std::string> NotKnown(const OperatingPoint& operating) const override {
    return parts_.recipe.envelope.NotKnown(operating);
  }

  /// What the predictor's changes are added to. @throws BenchError as `BaselineFor`; it must be called,
  /// with an empty path where there is no file, before the first prediction of a predictor that takes a
  /// baseline.
  void UseBaseline(const std::filesystem::path& file);

  double worst_disagreement() const override { return worst_disagreement_; }

  /// Signals that lie outside what was trained on but would not if two channels were exchanged, count as
  /// swapped. What else there is no prediction of: signal_inputs.h.
  std::variant<PredictedOutputs, SignalFault> Predict(std::span<const NamedSignal> signals,
                                                      double sample_rate_hz,
                                                      std::optional<double> samples_per_turn,
                                                      const OperatingPoint& operating) override;

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
