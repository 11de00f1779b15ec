// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>

#include "analysis/diagnosis/hysteresis/model.h"

namespace strainwave::analysis::diagnosis {

/// Numbers of the nominal model fitted to the records from starts that need no fit of the caller's.
Eigen::VectorXd FindNominal(const LoopRecords& records);

/// Fits a model to a grid where all but one effect have their numbers already, fitted without that one: the
/// effect's forms and shapes are ranked by what they would take off the residual beside all other numbers
/// moving along, the best of them are fitted, and the best fit is returned.
/// @param x  numbers of the whole model; those of `effect` are not read.
LoopSolution FitWithNewEffect(const LoopRecords& records, const LoopModel& model, std::size_t effect,
                              const LoopGrid& grid, const Eigen::VectorXd& x);

}  // namespace strainwave::analysis::diagnosis
