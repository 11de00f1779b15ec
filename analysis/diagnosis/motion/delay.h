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

/// The cause, and beside it a nuisance term for a torque that is recorded less than 0.15 sampling steps later
/// than it acts: channels that are read one after the other do that, and no drive does.
/// @param delay_s  as EstimateDelay has it of this grid
/// @param sampling_step_s  of the record
void AddDelayCause(const SharedGrid& grid, double delay_s, double sampling_step_s, const MotionUnits& units,
                   SeparableModel& model);

}  // namespace strainwave::analysis::diagnosis
