// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "analysis/diagnosis/hysteresis/gear.h"
#include "analysis/diagnosis/hysteresis/record.h"

namespace strainwave::analysis::diagnosis {

/// Places the peaks of the torque that lie between samples where the twist behind them says, as far as the
/// samples leave that open: the torque went beyond them by an eighth of the second difference there where the
/// turn is round, by half of it where two straight ramps meet. Friction keeps the peak until it has
/// yielded again; where samples are far apart beside its torque, that is more than noise, on the same side at
/// each turn. Turns that `samples` has stay.
///
/// @param law           of the nominal gear, about.
/// @param predicted_rad  what the nominal model says of the samples, the twist of that gear with its offset.
/// @return whether any peak shows.
bool SetInterSampleExtrema(const GearLaw& law, const Eigen::VectorXd& predicted_rad, double noise_rad,
                           LoopGrid& samples);

}  // namespace strainwave::analysis::diagnosis
