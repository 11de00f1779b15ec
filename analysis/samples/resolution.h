// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

namespace strainwave::analysis::samples {

/// Step of a quantised signal: the smallest change, if nearly all changes are whole multiples of it to within
/// `tolerance` steps; 0 for a continuous signal.
double QuantisationStep(std::span<const double> samples, double tolerance = 0.05);

}  // namespace strainwave::analysis::samples
