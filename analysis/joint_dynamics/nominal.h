// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "analysis/joint_dynamics/attribution.h"
#include "analysis/joint_dynamics/dynamics.h"

namespace strainwave::analysis::joint_dynamics {

/// Fingerprints by a network of healthy units alone: what it does not explain of each torque, and what its
/// torques come from. It has seen none of the files that are judged, so that nothing of a file's own network
/// or scale is in it. Columns, torques in units of their standard deviation in the network's training:
///   off_tauJ      |τ − f| of each joint;
///   against_tauJ  (τ − f) sgn q̇, what acts against the motion, near standstill less of it;
///   and the attributions' own (`NamesOf`).
std::vector<std::string> NominalNames(Fingerprint fingerprint, Eigen::Index joints);

/// samples × names. @param attributions  of the same samples by the same network.
Eigen::MatrixXd NominalFingerprints(const prediction::Ensemble& nominal, const JointMotion& motion,
                                    const Eigen::MatrixXd& attributions);

/// The columns of a joint among `NominalNames`: its errors, and its own attributions.
std::vector<std::vector<Eigen::Index>> ColumnsOfJoints(Fingerprint fingerprint, Eigen::Index joints);

}  // namespace strainwave::analysis::joint_dynamics
