// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>
#include <span>
#include <vector>

#include "analysis/diagnosis/motion/grid.h"

namespace strainwave::analysis::diagnosis {

/// Orders, a radian or metre, of the strongest lines over position in what the nominal terms and UsualEffects
/// leave.
std::vector<double> StrongestOrders(const MotionGrid& grid);

/// Columns (rows × any) of what may be in any record beside the nominal terms: UsualEffects, friction of low
/// speed, and lines over position.
/// @param orders   as StrongestOrders has them
/// @param shift_s  by which the path is taken later.
Eigen::MatrixXd UsualEffectsAndLines(const MotionGrid& grid, std::span<const double> orders,
                                     double shift_s = 0.0);

}  // namespace strainwave::analysis::diagnosis
