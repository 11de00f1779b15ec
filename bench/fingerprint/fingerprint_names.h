// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "analysis/joint_dynamics/attribution.h"

/// Names in the files of models of fingerprints.
namespace strainwave::bench {

inline constexpr const char* kNominalOnnx = "nominal.onnx";
inline constexpr const char* kClassifierOnnx = "classifier.onnx";

/// @throws std::invalid_argument for a name that there is not.
analysis::joint_dynamics::Fingerprint FingerprintKindNamed(const std::string& name);
analysis::joint_dynamics::Method AttributionMethodNamed(const std::string& name);

}  // namespace strainwave::bench
