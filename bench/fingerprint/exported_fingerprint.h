// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "analysis/joint_dynamics/attribution.h"
#include "bench/fingerprint/joint_records.h"
#include "bench/prediction/exported_model.h"
#include "bench/prediction/onnx_network.h"

namespace strainwave::bench {

inline constexpr int kFingerprintExportFormat = 2;

/// Whether a folder's recipe is one that `fingerprint export` wrote. @throws BenchError if it cannot be read.
bool IsExportedFingerprint(const std::filesystem::path& folder);

/// What `fingerprint export` wrote, as a monitor runs it on windows of a robot's joints: smoothed,
/// fingerprints by the nominal network, and the classifier's probabilities, mean over samples spread evenly
/// over the window. A window lies outside of the training where the middle one of its samples does, by its
/// states or by its fingerprint.
class ExportedFingerprint final : public ExportedModel {
 public:
  /// Reads the folder and tests it: hashes of all files, shapes, and the golden vectors through OpenCV.
  /// @throws BenchError naming the file, what is wrong with it and what was expected; also for expected
  ///   gradients, which need more of a network than its outputs.
  explicit ExportedFingerprint(const std::filesystem::path& folder);

  SignalNeeds needs() const override;
  const std::vector<std::string>& outputs() const override { return parts_.classes; }
  bool classes() const override { return true; }
  double coverage() const override { return 0.0; }
  double worst_disagreement() const override { return worst_disagreement_; }
  std::vector<std::string> NotKnown(const OperatingPoint&) const override { return {}; }

  std::variant<PredictedOutputs, SignalFault> Predict(std::span<const NamedSignal> signals,
                                                      double sample_rate_hz,
                                                      std::optional<double> samples_per_turn,
                                                      const OperatingPoint& operating) override;

 private:
  struct Golden {
    Eigen::RowVectorXd features, prediction;
  };
  struct Parts {
    Eigen::Index joints{};
    Smoothing smoothing;
    Acceleration acceleration{};
    double sample_rate_hz{};
    std::size_t least_samples{};
    Eigen::Index samples{};
    analysis::joint_dynamics::AttributionSettings attribution;
    Eigen::MatrixXd background;
    std::vector<std::string> classes;
    std::string nominal_bytes, classifier_bytes;
    std::vector<Golden> nominal_golden, classifier_golden;
  };
  static Parts Read(const std::filesystem::path& folder);

  Parts parts_;
  std::vector<std::string> channels_;
  OnnxNetwork nominal_;
  OnnxNetwork classifier_;
  analysis::prediction::Ensemble nominal_layers_;
  double worst_disagreement_{};
};

}  // namespace strainwave::bench
