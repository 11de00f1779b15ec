// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

#include "bench/prediction/train_predictor.h"

namespace strainwave::bench {

/// Draws what a training came to into `folder`, each picture as .svg and .png: `predicted` (records that the
/// network had not seen, one panel an output: of one reducer over its life, of several over what was
/// measured) or, for classes, `confusion` (of the honest folds); and `learning_curve` where there is one.
/// @return the pictures without their extension.
/// @throws GnuplotError, std::filesystem::filesystem_error as RenderPicture does.
std::vector<std::filesystem::path> DrawTraining(const TrainingData& data, const TrainingOutcome& outcome,
                                                const std::filesystem::path& folder);

}  // namespace strainwave::bench
