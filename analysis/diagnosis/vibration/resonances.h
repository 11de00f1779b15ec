// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>

#include "analysis/diagnosis/vibration/starts.h"

namespace strainwave::analysis::diagnosis {

/// Where a resonance is looked for.
struct ResonanceRange {
  double lowest_Hz{};
  double highest_Hz{};
  double least_damping{};
  bool by_shaft{};  // lines of the shaft may sweep across it
};

/// A lightly damped resonance within a range: driven by noise, ringing after impacts, or, where the speed
/// changes, by lines of the shaft. Nothing where a single tone explains most.
std::optional<TermFit> SearchResonance(const VibrationResidual& residual, std::size_t index,
                                       const ResonanceRange& range);

/// Whether something at this frequency, with this half of its width, is the resonance of a train among these
/// terms: what a train leaves about its resonance, since its impulses are neither quite even nor quite alike,
/// is that resonance again.
bool IsOfATrain(std::span<const VibrationTerm> terms, double frequency_Hz, double half_width_Hz);

/// Whether a resonance among these terms is but the resonance of a train that is there, too.
bool HasResonanceOfATrain(std::span<const VibrationTerm> terms);

}  // namespace strainwave::analysis::diagnosis
