// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "bench/prediction/train_predictor.h"

namespace strainwave::bench {

/// Measured and predicted over the cycle, one panel an output, for records that the network had not seen.
/// Writes `stem`.svg and `stem`.png.
/// @throws GnuplotError, std::filesystem::filesystem_error as RenderPicture does.
void DrawPredictions(const HeldOut& held_out, const std::vector<std::string>& outputs,
                     const std::filesystem::path& stem);

}  // namespace strainwave::bench
