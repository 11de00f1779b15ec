// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "analysis/diagnosis/vibration/starts.h"

/// Orders that a bearing may have, and no other thing.
namespace strainwave::analysis::diagnosis {

/// Standard errors of the angle's scale that a known order may be off by.
inline constexpr double kScaleRange = 3.0;

/// Half-widths of a resonance in which harmonics of impulses are observable.
inline constexpr double kResonanceReach = 2.0;

/// Of the envelope of a train that slips, as many as are always observable.
inline constexpr double kHarmonicsOfSlipping = 2.0;

/// Not another's order, as sharply as so many harmonics and the angle's scale say it.
/// @param slip  by how much the order may be off since impulses slip
bool IsBearingOrder(const VibrationResidual& residual, double order, double harmonics, double slip = 0.0);

/// Whether the order of a train or of a family of lines is a bearing's: none that others have, impulses that
/// die away, and more that is observable than one line at a whole order.
bool IsBearing(const VibrationResidual& residual, const VibrationTerm& term);

}  // namespace strainwave::analysis::diagnosis
