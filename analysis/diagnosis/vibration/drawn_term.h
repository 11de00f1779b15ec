// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

#include "analysis/diagnosis/study.h"
#include "analysis/diagnosis/vibration/samples.h"
#include "analysis/diagnosis/vibration/starts.h"

namespace strainwave::analysis::diagnosis {

/// A cause drawn at random: a mesh as its two lines, the engagement of teeth as one, a bearing's defect and a
/// crack as impulses that excite a resonance, a torsional resonance as one that rings after a single impact,
/// an imbalance; in every channel with a size and a sign of its own. Its amount is the amplitude in the
/// strongest one. The samples outlive it.
/// @returns nothing for another cause, or where the samples show nothing of it
std::optional<DrawnEffect> DrawVibrationEffect(const VibrationSamples& samples, VibrationCause cause,
                                               std::uint64_t draw);

}  // namespace strainwave::analysis::diagnosis
