// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "analysis/diagnosis/vibration/starts.h"

namespace strainwave::analysis::diagnosis {

/// Of the order: impulses that come more seldom than this do not show a change.
inline constexpr double kLargestSideband = 0.45;

/// Of the sampling rate: the lowest resonance that trains are looked for with.
inline constexpr double kLowestTrainResonance = 0.03;

/// Where a train of impulses may be: an order, and the resonance that it excites.
struct TrainStart {
  double order{};
  double resonance_Hz{};
  double excess{};             // −ln p without the trials factor
  double sideband{};           // order of the change of the impulses that says so; 0 for even ones
  double relative_noise{1.0};  // power of the noise about the resonance, beside white noise of its variance
};

/// Trains of impulses that excite a resonance a resonance, coherently, for resonances all over the spectrum:
/// the residual is matched to the resonance, and what it holds at even angles is added up with its phase, for
/// every order and phase of the impulses. Works while the speed changes, when a resonance wanders through the
/// harmonics and no spectrum over angle shows them. First record only.
/// @param sidebands  impulses that change so many times a turn count with what they change by; 0 for even
///                   ones.
/// @param allowed    says which orders count.
std::vector<TrainStart> FindTrains(const VibrationResidual& residual, double lowest, double highest,
                                   std::span<const double> sidebands, std::size_t count,
                                   const std::function<bool(double order)>& allowed);

}  // namespace strainwave::analysis::diagnosis
