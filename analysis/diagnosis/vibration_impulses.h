// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "analysis/diagnosis/vibration_starts.h"
#include "analysis/diagnosis/vibration_trains.h"

namespace strainwave::analysis::diagnosis {

/// The best train of ringing impulses that one of the starts leads to, plain or with one of the modulations
/// (orders of the input angle). Nothing where a single line explains most of it.
std::optional<VibrationSolution> SearchImpulses(const VibrationRemainder& remainder, std::size_t index,
                                                const std::vector<TrainStart>& starts,
                                                const std::vector<double>& modulations);

}  // namespace strainwave::analysis::diagnosis
