// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "analysis/diagnosis/vibration/starts.h"

namespace strainwave::analysis::diagnosis {

/// A band of a spectrum that is louder than its surroundings.
struct NoiseBand {
  double excess{};  // −ln p of one look
  double centre_Hz{};
  double width_Hz{};
  double power{};  // above the background, in cells
};

/// The loudest bands, strongest first, none wider than 0.7 of its frequency, none within another.
/// @param no_tones  passes over bands whose power is mostly that of one tone.
std::vector<NoiseBand> FindBands(const VibrationSpectrum& spectrum, double lowest_Hz, double highest_Hz,
                                 double least_excess, bool no_tones, std::size_t count);

/// A lightly damped resonance between two frequencies: driven by noise, ringing after knocks, or (where the
/// speed changes, and `by_shaft` is set) by lines of the shaft that sweep across it. Nothing where a single
/// tone explains most.
std::optional<VibrationSolution> SearchResonance(const VibrationRemainder& remainder, std::size_t index,
                                                 double lowest_Hz, double highest_Hz, bool by_shaft);

}  // namespace strainwave::analysis::diagnosis
