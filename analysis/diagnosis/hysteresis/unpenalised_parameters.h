// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "analysis/diagnosis/hysteresis/model.h"
#include "analysis/diagnosis/hysteresis/search.h"

namespace strainwave::analysis::diagnosis {

/// How many of the causes' nonlinear parameters (a level, a time constant, a state at the start) need not be
/// charged for (`known_before.h`): what bounds a fit is what is known of them before. Amounts are charged,
/// and the locations of nuisance terms.
double UnpenalisedParameters(const LoopModel& model, const LoopSolution& solution, const LoopGrid& grid);

}  // namespace strainwave::analysis::diagnosis
