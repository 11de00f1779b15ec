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

/// Weight of each sample, 1 on average over a record: one over the variance of its twist, which holds the
/// angle's own noise and what the torque's brings where the gear is as compliant as there. Below T1 that is
/// two to three times as much as above T2.
std::vector<double> WeightsByTorqueNoise(const LoopRecords& records, const Eigen::VectorXd& gear_rad);

}  // namespace strainwave::analysis::diagnosis
