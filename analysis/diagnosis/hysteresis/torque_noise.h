// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "analysis/diagnosis/hysteresis/record.h"

namespace strainwave::analysis::diagnosis {

/// The twist that the noise taken off the torque would have brought: straight, with the compliance that the
/// nominal gear has there. What smoothing leaves of that noise is slow, and too small to be seen in the
/// autocorrelation of the residual, but all slow effects are judged beside it; with the response to the rest
/// of it the noise is white again.
///
/// @param gear_rad  twist of the nominal gear, a sample each.
Eigen::VectorXd ResponseToTorqueNoise(const LoopRecords& records, const Eigen::VectorXd& gear_rad);

}  // namespace strainwave::analysis::diagnosis
