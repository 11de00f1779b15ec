// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>

#include "analysis/diagnosis/motion/grid.h"

namespace strainwave::analysis::diagnosis {

/// Columns (rows × any) of what may be in any record beside the nominal terms: UsualEffects, friction of low
/// speed, and the strongest lines over position in what the nominal terms and UsualEffects leave.
/// @param shift_s  by which the path is taken later.
Eigen::MatrixXd UsualEffectsAndLines(const MotionGrid& grid, double shift_s = 0.0);

}  // namespace strainwave::analysis::diagnosis
