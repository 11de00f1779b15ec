// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>

#include "analysis/diagnosis/vibration/starts.h"

namespace strainwave::analysis::diagnosis {

/// 2N and 2N + 2 per turn, their multiples, sidebands of the input and output turn: the set of them that is
/// least likely to be chance. Where the speed changes, the gains of its lines may follow it: on their way to
/// the sensors they pass resonances of the structure.
std::optional<TermFit> SearchGearMesh(const VibrationResidual& residual, std::size_t index);

/// Logarithm of how many sets of as many lines beside the first two, with as many gains that follow the
/// speed, observable in as many channels, with the scale of the angle held or not, there are to choose from.
double LogChoicesOfMesh(const VibrationSamples& samples, const VibrationTerm& mesh);

}  // namespace strainwave::analysis::diagnosis
