// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "analysis/diagnosis/records.h"
#include "analysis/diagnosis/vibration/samples.h"

namespace strainwave::analysis::diagnosis {

/// Angle and speed of the input shaft, from the column of angles if there is one, else from the speed: both
/// positive, whichever way it turns. Leaves the run without an angle where the record knows neither.
/// @param which  names the record in messages
/// @throws std::invalid_argument in words for a technician: a shaft that stands still or turns back.
void TakeShaft(VibrationRun& run, const VibrationData& record, const std::string& which);

/// Takes one speed for the whole run.
void TakeSteadySpeed(VibrationRun& run, double speed_rad_per_s);

/// Speeds, their mean, their spread and the turns, from the angle: over about a quarter of a turn, so that
/// the steps of an encoder do not show.
void FindSpeeds(VibrationRun& run);

}  // namespace strainwave::analysis::diagnosis
