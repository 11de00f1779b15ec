// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "analysis/diagnosis/vibration/starts.h"

/// A resonance that is heard after a few knocks only.
namespace strainwave::analysis::diagnosis {

/// 0 for a term that is no knocks.
std::size_t KnockCount(const VibrationTerm& term);

/// Frequencies between two at which knocks ring loudest, all that there are in a record together; the loudest
/// first. One record only.
std::vector<double> FindKickedFrequencies(const VibrationRemainder& remainder, double lowest_Hz,
                                          double highest_Hz, std::size_t count);

/// Knocks that let a resonance about a frequency ring; nothing where none is loud enough.
std::optional<TermFit> SearchKicks(const VibrationRemainder& remainder, std::size_t index,
                                   double frequency_Hz);

}  // namespace strainwave::analysis::diagnosis
