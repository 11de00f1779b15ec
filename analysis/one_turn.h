// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "analysis/transmission_error.h"

namespace strainwave::analysis {

/// The error of a sweep over one turn of the output, angles rising from 0 to below 360°.
struct TurnCurve {
  std::vector<double> angle_deg;
  std::vector<double> error_arcmin;
};

/// The samples folded into one turn and put in the order of the angle, so that a sweep to −360° lies over one
/// to +360°.
TurnCurve OneTurn(const SweepError& sweep);

}  // namespace strainwave::analysis
