// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "bench/prediction/baseline_file.h"

namespace strainwave::bench {

/// The baseline of one reducer for a predictor of changes: means over its first records, as many as in
/// training, of all features of the recipe's channels and of all outputs.
/// @param paths  its campaign, or its labelled records in their order.
/// @throws BenchError if the predictor takes no baseline, the records are of several reducers, are not as in
///   training or lack an output, or there are too few of them.
ReducerBaseline ReadReducerBaseline(const std::vector<std::filesystem::path>& paths,
                                    const FeatureRecipe& recipe, const std::vector<std::string>& outputs);

}  // namespace strainwave::bench
