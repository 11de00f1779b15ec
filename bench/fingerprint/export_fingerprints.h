// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "bench/fingerprint/train_fingerprints.h"

namespace strainwave::bench {

struct FingerprintExport {
  std::filesystem::path folder;
  double nominal_disagreement{};  // of OpenCV with the trained network, at most, in standard deviations of a
                                  // torque
  double classifier_disagreement{};  // in probability
};

/// Writes `nominal.onnx` (states to torques) and `classifier.onnx` (fingerprints to probabilities),
/// `recipe.json` (how a record becomes states and these fingerprints, the background, golden vectors, hashes
/// of the files beside it) and `model_card.json` and `model_card.md`; reads both networks back with OpenCV
/// and compares.
/// @throws BenchError if they disagree by more than a hundred-thousandth; DataFileError.
FingerprintExport ExportFingerprints(const FingerprintModel& model, const std::filesystem::path& folder);

}  // namespace strainwave::bench
