// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

#include "bench/fingerprint/train_fingerprints.h"

namespace strainwave::bench {

/// Draws what a training came to into `folder`, each picture as .svg and .png: `torques` (measured, by the
/// nominal network, and what is left, of a healthy and a faulty file), `share_of_joints` (mean attribution of
/// each joint in healthy and faulty files), `samples` (nominal fingerprints, a dot a sample, healthy and
/// faulty), `roc` (of the network on each split) and `confusion` (the same).
/// @return the pictures without their extension.
/// @throws GnuplotError, std::filesystem::filesystem_error as RenderPicture does.
std::vector<std::filesystem::path> DrawFingerprints(const FingerprintData& data,
                                                    const FingerprintOutcome& outcome,
                                                    const std::filesystem::path& folder);

}  // namespace strainwave::bench
