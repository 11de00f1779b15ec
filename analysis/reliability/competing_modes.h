// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include "analysis/reliability/weibull_fit.h"

namespace strainwave::analysis::reliability {

/// A life, and by what it ended.
struct ModeLifetime {
  Lifetime life;
  int mode{-1};  // from 0 up; −1 of a suspended unit
};

/// Independent modes, each with a Weibull law of its own, of which the first ends a unit: R = Π R_k. To one
/// mode, failures by the others are suspensions. Source: docs/sources.md#lawless-2003, chapter 9.
struct CompetingModes {
  std::vector<WeibullFit> modes;
  double log_likelihood{};
};

/// The lives as one mode sees them: failures by others suspended (an interval at its beginning).
std::vector<Lifetime> LivesOfMode(std::span<const ModeLifetime> lives, int mode);

/// @param modes  how many there are. @throws NoEstimate for a mode that has none, with its index in the
/// words.
CompetingModes FitCompetingModes(std::span<const ModeLifetime> lives, int modes,
                                 const std::vector<std::string>& names);

/// The time by which a share has failed by any mode.
double SystemQuantile(const CompetingModes& fit, double share_failed);

/// Its bounds: the profile over the shares of the hazard that each mode has there, and all shapes.
/// `corrected` is the likelihood ratio's; signed roots of modes are not standardised.
BoundedEstimate BoundsOfSystemQuantile(const CompetingModes& fit, std::span<const ModeLifetime> lives,
                                       double share_failed, double level);

}  // namespace strainwave::analysis::reliability
