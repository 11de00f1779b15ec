// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>

#include "bench/prediction/predictor_file.h"

namespace strainwave::bench {

/// What was written, and how well it reads back.
struct ExportSummary {
  std::filesystem::path folder;
  std::size_t onnx_bytes{};
  std::size_t inputs{};
  std::size_t outputs{};
  bool classes{};
  // Of OpenCV with the trained networks, at most: a share of each output, and of its error.
  double disagreement_of_value{};
  double disagreement_of_residual{};
};

/// Writes `model.onnx`, `recipe.json` (how a record becomes its features, with the SHA-256 of the model),
/// `model_card.json` and `model_card.md`; reads the network back with OpenCV and compares.
/// @throws BenchError if the two disagree by more than a hundred-thousandth of the output; DataFileError.
ExportSummary ExportPredictor(const Predictor& predictor, const std::filesystem::path& folder);

}  // namespace strainwave::bench
