// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "analysis/diagnosis/hysteresis/record.h"
#include "analysis/diagnosis/study.h"

namespace strainwave::analysis::diagnosis {

/// What a loop's residual is looked at over. The output angle is where the nominal model puts the output
/// (`records.samples.position_rad`): over the measured angle its own noise would pass for a shape wherever
/// the gear stands still, as in a hold the highest readings come last.
std::vector<Regressor> RegressorsOf(const LoopRecords& records);

}  // namespace strainwave::analysis::diagnosis
