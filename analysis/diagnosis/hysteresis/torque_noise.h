// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "analysis/diagnosis/hysteresis/record.h"

namespace strainwave::analysis::diagnosis {

/// Slope of the nominal gear's twist over the torque at each sample (rad/Nm), from 0 to three times the
/// usual.
/// @param gear_rad  twist of the nominal gear, a sample each.
std::vector<double> CompliancesOf(const LoopRecords& records, const Eigen::VectorXd& gear_rad);

/// The twist that the noise taken off the torque would have brought: straight, with the compliance that the
/// nominal gear has there. What smoothing leaves of that noise is slow, and too small to be seen in the
/// autocorrelation of the residual, but all slow effects are judged beside it; with the response to the rest
/// of it the noise is white again.
/// @param compliances_rad_per_Nm  of `CompliancesOf`.
Eigen::VectorXd ResponseToTorqueNoise(const LoopRecords& records,
                                      std::span<const double> compliances_rad_per_Nm);

/// Weight of each sample, 1 on average over a record: one over the variance of its twist, which holds the
/// angle's own noise and what the torque's brings where the gear is as compliant as there. Below T1 that is
/// two to three times as much as above T2.
/// @param compliances_rad_per_Nm  of `CompliancesOf`.
std::vector<double> WeightsByTorqueNoise(const LoopRecords& records,
                                         std::span<const double> compliances_rad_per_Nm);

}  // namespace strainwave::analysis::diagnosis
