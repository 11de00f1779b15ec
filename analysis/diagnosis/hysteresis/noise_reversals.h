// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "analysis/loop_branches.h"

namespace strainwave::analysis::diagnosis {

/// A signal without the small reversals that its own errors make: on each branch isotonic regression,
/// weighted by the errors, wherever that moves no value by more than its error lets. A held load then stays
/// where it is; what noise leaves of it would go to and fro and wind up friction, which remembers the
/// furthest of it.
///
/// @param errors    standard errors of the values, > 0.
/// @param branches  of the values, end to end; a branch is taken to the end of the hold that follows it.
/// Source: pool-adjacent-violators, Ayer et al., Ann. Math. Stat. 26 (1955) 641.
std::vector<double> WithoutNoiseReversals(std::span<const double> values, std::span<const double> errors,
                                          double noise, std::span<const Branch> branches);

}  // namespace strainwave::analysis::diagnosis
