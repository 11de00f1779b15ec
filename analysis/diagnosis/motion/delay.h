// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "analysis/diagnosis/motion/grid.h"
#include "analysis/diagnosis/motion/terms.h"

namespace strainwave::analysis::diagnosis {

/// How much later than it was recorded the torque acts: the delay at which the nominal terms, moved, leave
/// least beside the usual effects and the strongest lines over position; 0 where none of them leaves clearly
/// less.
double EstimateDelay_s(const MotionGrid& grid);

/// @param delay_s  EstimateDelay_s of this grid
void AddDelayCause(const SharedGrid& grid, double delay_s, const MotionUnits& units, SeparableModel& model);

}  // namespace strainwave::analysis::diagnosis
