// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

#include "bench/faults/train_faults.h"
#include "daq/record.h"

namespace strainwave::bench {

/// Draws what a training came to into `folder`, each picture as .svg and .png:
///   deviations          of each class over the levels, a panel a channel;
///   training            errors of training, validation and test over the epochs;
///   outputs             of each record by what had not seen its unit, a panel an output;
///   confusion_SPLIT     of each split;
///   levels              accuracy over the levels that are kept, where they were compared.
/// @return the pictures without their extension.
/// @throws GnuplotError, std::filesystem::filesystem_error as RenderPicture does.
std::vector<std::filesystem::path> DrawFaults(const FaultRecords& records, const FaultOutcome& outcome,
                                              const std::filesystem::path& folder);

/// A channel of a record above its details and its last approximation, each with its band.
std::filesystem::path DrawDetails(const daq::Record& record, const std::string& channel,
                                  double sample_rate_hz, const analysis::features::DetailRecipe& recipe,
                                  const std::filesystem::path& stem);

}  // namespace strainwave::bench
