// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "analysis/diagnosis/vibration/starts.h"
#include "analysis/diagnosis/vibration/trains.h"

namespace strainwave::analysis::diagnosis {

/// Damping ratios of the resonances that a search for trains tries.
inline constexpr double kLeastTrainDamping = 0.008;
inline constexpr double kMostTrainDamping = 0.6;

/// The harmonic of an order that is the strongest line.
int StrongestHarmonic(const VibrationResidual& residual, double order);

/// The best train of ringing impulses that one of the starts leads to, plain or with one of the modulations
/// (orders of the input angle). Nothing where a single line explains most of it.
std::optional<TermFit> SearchImpulses(const VibrationResidual& residual, std::size_t index,
                                      const std::vector<TrainStart>& starts,
                                      const std::vector<double>& modulations,
                                      const std::function<bool(double order)>& allowed);

/// Smooth pulses at a known order: where they stand is read off the lines at its harmonics. Their width is
/// one of a few, or a number of the fit where that pays.
/// @param slow_order  of a change of their height that is tried; 0 for none
TermFit SearchPulses(const VibrationResidual& residual, std::size_t index, double order, double slow_order);

}  // namespace strainwave::analysis::diagnosis
