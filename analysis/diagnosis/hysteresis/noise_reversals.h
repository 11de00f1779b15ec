// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "analysis/loop_branches.h"

namespace strainwave::analysis::diagnosis {

/// A signal without the small reversals that are left of its noise: on each branch isotonic regression,
/// weighted by the values' errors, wherever that moves none of them by more than the noise of one sample. A
/// held load then stays where it is; what goes to and fro would wind up friction, which keeps the
/// furthest of it.
///
/// @param errors    standard errors of the values, > 0.
/// @param noise     standard deviation of a sample before its noise was taken off.
/// @param branches  of the values, end to end; a branch is taken to the end of the hold that follows it.
std::vector<double> WithoutNoiseReversals(std::span<const double> values, std::span<const double> errors,
                                          double noise, std::span<const Branch> branches);

}  // namespace strainwave::analysis::diagnosis
