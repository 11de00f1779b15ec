// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "analysis/diagnosis/vibration/starts.h"

/// Searches for causes whose lines belong together.
namespace strainwave::analysis::diagnosis {

/// 2 (1 + 1/N) per turn and its double, smooth: how often a tooth of one spline meets the next of the other.
std::optional<TermFit> SearchToothEngagement(const VibrationResidual& residual, std::size_t index);

/// An order between 2.3 and 20 that is no multiple of a half, with several harmonics or sidebands: as lines,
/// or as impulses that excite a resonance.
std::optional<TermFit> SearchBearing(const VibrationResidual& residual, std::size_t index);

/// 2 (1 + 1/N) per turn and its harmonics: as lines, or as impulses that excite a resonance; or 2 ± 1/N, what
/// a point of the flexspline that comes by once per output turn makes of the shaft's own line. One or two
/// lines alone that are so large that a pulse would show a third are none.
std::optional<TermFit> SearchCrack(const VibrationResidual& residual, std::size_t index);

/// Logarithm of how many resonances, and phases in their period at which a response begins, a crack's was
/// chosen from.
double LogSearchLocationsOfCrack(const VibrationSamples& samples, const VibrationTerm& crack);

/// Logarithm of the search locations that there are for even impulses of this order, resonance and damping,
/// over those that the rule of a bearing counts; 0 for lines and for impulses that slip. A cell in order,
/// time, ring and damping is as wide as a train must move to be another one: the higher its harmonics and the
/// longer its responses, the more cells there are. Equal orders, and octaves of resonances and dampings, have
/// the same share of what chance may find, so that a train of low harmonics pays for the few it might have
/// had.
double LogSearchLocationsOfTrain(const VibrationSamples& samples, const VibrationTerm& train);

/// Takes the solution if its BIC is the best so far.
void Keep(TermFit solution, std::optional<TermFit>& best);

}  // namespace strainwave::analysis::diagnosis
