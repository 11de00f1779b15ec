// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "analysis/diagnosis/vibration/starts.h"

namespace strainwave::analysis::diagnosis {

/// A resonance that impulses may ring.
struct RingPlace {
  double ring_Hz{};
  double damping_ratio{};
};

/// Where a train of impulses may be: an order, and the resonance that it rings.
struct TrainStart {
  double order{};
  RingPlace ring;
  double excess{};  // −ln p of one look
};

/// Resonances worth a look: bands that are louder than their surroundings, and the strongest line.
std::vector<RingPlace> FindRings(const VibrationRemainder& remainder, std::size_t count);

/// Trains of impulses in one resonance, coherently: the residual is matched to the ring, and what it holds at
/// even angles is added up with its phase, for every order and place of the impulses. Works while the speed
/// changes, when a resonance wanders through the harmonics and no spectrum over angle shows them. First
/// record only.
/// @param sideband  impulses that change so many times a turn count with what they change by; 0 for even
/// ones.
/// @param allowed   says which orders count.
std::vector<TrainStart> FindTrains(const VibrationRemainder& remainder, const RingPlace& ring, double lowest,
                                   double highest, std::span<const double> sidebands, std::size_t count,
                                   const std::function<bool(double order)>& allowed);

}  // namespace strainwave::analysis::diagnosis
