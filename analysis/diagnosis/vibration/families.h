// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "analysis/diagnosis/vibration/starts.h"

/// Searches for causes whose lines belong together.
namespace strainwave::analysis::diagnosis {

/// 2N and 2N + 2 per turn, their multiples, sidebands of the input and output turn: those that pay.
std::optional<TermFit> SearchGearMesh(const VibrationRemainder& remainder, std::size_t index);

/// An order between 2 and 20 that is no multiple of a half, with several harmonics or sidebands: as lines, or
/// as impulses that ring.
std::optional<TermFit> SearchBearing(const VibrationRemainder& remainder, std::size_t index);

/// 2 (1 + 1/N) per turn and its harmonics: as lines, or as impulses that ring.
std::optional<TermFit> SearchCrack(const VibrationRemainder& remainder, std::size_t index);

/// Takes the solution if its BIC is the best so far.
void Keep(TermFit solution, std::optional<TermFit>& best);

}  // namespace strainwave::analysis::diagnosis
