// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "analysis/diagnosis/vibration/starts.h"

/// Searches for causes whose lines belong together.
namespace strainwave::analysis::diagnosis {

/// 2 (1 + 1/N) per turn and its double, smooth: how often a tooth of one spline meets the next of the other.
std::optional<TermFit> SearchToothEngagement(const VibrationRemainder& remainder, std::size_t index);

/// An order between 2.3 and 20 that is no multiple of a half, with several harmonics or sidebands: as lines,
/// or as impulses that ring.
std::optional<TermFit> SearchBearing(const VibrationRemainder& remainder, std::size_t index);

/// 2 (1 + 1/N) per turn and its harmonics: as lines, or as impulses that ring. One or two lines alone that
/// are so loud that a pulse would show a third are none.
std::optional<TermFit> SearchCrack(const VibrationRemainder& remainder, std::size_t index);

/// Logarithm of how many rings, and places in their period at which one begins, a crack that rings was chosen
/// from.
double LogPlacesOfCrack(const VibrationSamples& samples, const VibrationTerm& crack);

/// Takes the solution if its BIC is the best so far.
void Keep(TermFit solution, std::optional<TermFit>& best);

}  // namespace strainwave::analysis::diagnosis
