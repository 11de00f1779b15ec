// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "analysis/diagnosis/vibration/starts.h"

/// A resonance that is observable after a few impacts only.
namespace strainwave::analysis::diagnosis {

/// 0 for a term that is no impacts.
std::size_t ImpactCount(const VibrationTerm& term);

/// Frequencies between two at which the responses to impacts are largest, all that there are in a record
/// together; the largest first. One record only.
std::vector<double> FindExcitedFrequencies(const VibrationResidual& residual, double lowest_Hz,
                                           double highest_Hz, std::size_t count);

/// Impacts that excite a resonance about a frequency; nothing where none is large enough.
std::optional<TermFit> SearchTransients(const VibrationResidual& residual, std::size_t index,
                                        double frequency_Hz);

}  // namespace strainwave::analysis::diagnosis
