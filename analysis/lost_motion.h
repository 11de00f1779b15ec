// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "analysis/transmission_error.h"

namespace strainwave::analysis {

/// Mean over the output angle of first − second, both interpolated linearly at the other's angles, so that
/// grids may be offset. Angles count modulo a turn: a sweep that was zeroed at its own start still meets the
/// same teeth at the same remainder. None if the two have no angle in common.
std::optional<double> MeanDifferenceAtEqualAngle(const SweepError& first, const SweepError& second);

}  // namespace strainwave::analysis
