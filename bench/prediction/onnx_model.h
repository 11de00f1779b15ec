// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "analysis/prediction/fit_predictor.h"

namespace strainwave::bench {

/// Free text under names, for the file's metadata.
using OnnxMetadata = std::vector<std::pair<std::string, std::string>>;

inline constexpr int kOnnxOpset = 13;

/// The bytes of an ONNX model of that opset, float32, that needs nothing beside it but the features:
///   input  `features`   records × inputs, unscaled;
///   output `prediction` records × outputs, in the outputs' units, the mean of the networks;
///   output `half_width` records × outputs, of the interval about it;
///   where classes are predicted, in place of these two: `probability` records × classes, the mean of the
///   networks; output `distance`   records × 1, above 1 when the record lies outside what was trained on.
/// How many records come together is left open. For readers that size their memory beforehand and refuse that
/// (OpenCV 4.6), `OnnxNetwork` sets it to one.
///
/// @throws std::invalid_argument if there is no network.
///
/// Source: ONNX intermediate representation 7, operators of opset 13. A series of values is written as an
/// image of height one, since more readers know two-dimensional convolutions than one-dimensional ones.
std::string OnnxBytes(const analysis::prediction::FittedPredictor& fitted, const OnnxMetadata& metadata);

}  // namespace strainwave::bench
