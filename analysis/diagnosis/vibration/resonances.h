// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "analysis/diagnosis/vibration/starts.h"

namespace strainwave::analysis::diagnosis {

/// A lightly damped resonance between two frequencies: driven by noise, ringing after knocks, or (where the
/// speed changes, and `by_shaft` is set) by lines of the shaft that sweep across it. Nothing where a single
/// tone explains most.
std::optional<TermFit> SearchResonance(const VibrationRemainder& remainder, std::size_t index,
                                       double lowest_Hz, double highest_Hz, bool by_shaft);

}  // namespace strainwave::analysis::diagnosis
