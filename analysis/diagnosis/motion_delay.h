// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "analysis/diagnosis/motion_grid.h"
#include "analysis/diagnosis/motion_terms.h"

namespace strainwave::analysis::diagnosis {

/// How much later than it was recorded the torque acts: the delay at which the nominal terms, moved, leave
/// least beside the usual effects and the strongest lines over position; never below 0.
struct DelayEstimate {
  double delay_s{};
  double drop{};  // of −2 log-likelihood against no delay
};
DelayEstimate EstimateDelay(const MotionGrid& grid);

/// Timing with which the grid is to be made again: a torque that is held from sample to sample acts half a
/// sample late, which is no effect; where it acts later than that, reversals show in the torque before the
/// motion.
MotionTiming SettleTiming(const MotionGrid& grid, double step_s);

void AddDelayCause(const SharedGrid& grid, const MotionUnits& units, SeparableModel& model);

}  // namespace strainwave::analysis::diagnosis
