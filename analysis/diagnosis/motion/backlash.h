// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "analysis/diagnosis/motion/terms.h"

namespace strainwave::analysis::diagnosis {

/// The cause "backlash": a load that is loose in a gap. None where the motion is too small for one.
void AddBacklash(const SharedGrid& grid, const MotionUnits& units, SeparableModel& model);

/// What a load behind a gap asks for beyond one that is held tight, per unit of its inertia, at the points
/// and before the low-pass.
/// @param nonlinear_parameters  of the cause's term
std::vector<double> InertiaBehindBacklashAtPoints(const MotionGrid& grid,
                                                  std::span<const double> nonlinear_parameters);

}  // namespace strainwave::analysis::diagnosis
