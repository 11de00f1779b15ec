// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "analysis/diagnosis/vibration/samples.h"

namespace strainwave::analysis::diagnosis {

/// Where the speed of a shaft comes from: a number in the file, a column of it, or the shaft's own lines.
enum class SpeedSource { kStated, kMeasured, kItsLines };

/// The speed in a file is a nominal one, or the drive's: slip and slow wander are corrected by the shaft's
/// own lines at 1 and 2 per turn, where they are strong enough to tell. Changes angle, speed and nominal
/// columns, sets `order_uncertainty`, and says in the warnings what it did.
/// What nobody stated is taken as the lines say it.
void CorrectSpeed(VibrationSamples& samples, SpeedSource source);

/// Where no speed is known at all: the shaft's speed from a clear pair of lines, f and 2f.
/// @returns 0 where there is none.
double SpeedFromLines(const VibrationSamples& samples);

}  // namespace strainwave::analysis::diagnosis
