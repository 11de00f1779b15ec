// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

namespace strainwave::analysis::samples {

/// Step of a quantised signal: the smallest change, if nearly all changes are whole multiples of it to within
/// `tolerance` steps; 0 for a continuous signal.
double QuantisationStep(std::span<const double> samples, double tolerance = 0.05);

/// Whether a signal stands on multiples of a step and a constant. One that goes on evenly changes by equal
/// amounts, too, but not by those of the way there and the way back alike.
/// @param step  above 0, as `QuantisationStep` found it.
bool StandsOnSteps(std::span<const double> samples, double step);

/// `QuantisationStep` of a signal that moves on by about as many steps from each sample to the next, as a
/// sweep does: what its moves differ by stands on the steps, too.
double QuantisationStepOfSweep(std::span<const double> samples);

}  // namespace strainwave::analysis::samples
