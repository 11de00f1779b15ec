// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "analysis/diagnosis/vibration/samples.h"
#include "analysis/diagnosis/vibration/terms.h"

namespace strainwave::analysis::diagnosis {

/// The chain of samples, each about a period of `order` behind the one before, that holds most: of all chains
/// by dynamic programming. Over a gap in the record it is some whole number of periods.
/// @param score  of an impulse at a sample, in ln of likelihood
std::vector<std::size_t> BestChain(const VibrationRun& run, double order, const std::vector<double>& score);

/// Order, phase and slips of a train of impulses from the shaft's angles at them; those that a gap holds are
/// counted, and slip as the last one before them.
/// @param term  a train with its order, by which the impulses are counted
/// @returns false where there are too few
bool TakeImpulses(const VibrationRun& run, const std::vector<double>& angles_rad, VibrationTerm& term);

}  // namespace strainwave::analysis::diagnosis
