// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "analysis/prediction/ensemble.h"

namespace strainwave::bench {

/// The network of a file that `OnnxBytes` wrote of one member of dense layers, in numbers rounded to float32:
/// for what needs to look into a network, as explanations do. To run it: `OnnxNetwork`, which also judges
/// files of unknown origin and comes first.
/// @throws std::invalid_argument for any other file.
analysis::prediction::Ensemble DenseEnsembleFrom(const std::string& onnx_bytes);

}  // namespace strainwave::bench
