// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "analysis/diagnosis/motion/grid.h"
#include "analysis/diagnosis/motion/terms.h"

namespace strainwave::analysis::diagnosis {

/// A delay, and what the motion model moved by it leaves.
struct DelayEstimate {
  double delay_s{};
  double square_sum{};  // torque or force, squared
};

/// How much later than it was recorded the torque acts, negative where it was recorded later than it acts:
/// the delay at which the nominal terms, moved, leave least beside the usual effects and the strongest lines
/// over position; 0 where none of them leaves clearly less.
DelayEstimate EstimateDelay(const MotionGrid& grid);

/// @param delay_s  as EstimateDelay has it of this grid
void AddDelayCause(const SharedGrid& grid, double delay_s, const MotionUnits& units, SeparableModel& model);

}  // namespace strainwave::analysis::diagnosis
