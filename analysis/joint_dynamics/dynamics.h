// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "analysis/prediction/ensemble.h"

namespace strainwave::analysis::joint_dynamics {

/// A record of joints after smoothing, one row a sample.
struct JointMotion {
  Eigen::MatrixXd states;      // n × 3 joints: all positions, then all velocities, then all accelerations
  Eigen::MatrixXd torques_Nm;  // n × joints

  Eigen::Index size() const { return states.rows(); }
  Eigen::Index joints() const { return torques_Nm.cols(); }
};

/// Rows spread evenly over a record, from the first to the last; all of them where there are no more.
std::vector<Eigen::Index> EvenRows(Eigen::Index rows, Eigen::Index most);
JointMotion RowsOf(const JointMotion& motion, const std::vector<Eigen::Index>& rows);
/// One below the other. @throws std::invalid_argument if there is none, or they differ in their joints.
JointMotion Stacked(const std::vector<JointMotion>& motions);

/// How a network of the dynamics is trained.
struct DynamicsSettings {
  int hidden{64};  // units of each of the two layers
  int epochs{1000};
  int batch{256};
  double rate{1e-3};
  int patience{20};
  std::uint64_t seed{42};
};

/// A network from states to torques: two layers of tanh, linear at the output, mean squared error of each
/// torque over its variance, Adam, early stopping by a fifth of each part in blocks of time.
/// @param part  n; the record of each row, so that blocks of time are of one record.
/// @throws std::invalid_argument for fewer rows than `kFewestRows`; prediction::TrainingEnded.
///
/// Source: docs/sources.md#actuators-2025, table 2.
prediction::Ensemble TrainDynamics(const JointMotion& motion, const std::vector<int>& part,
                                   const DynamicsSettings& settings,
                                   const prediction::TrainingProgress& progress = {});
inline constexpr Eigen::Index kFewestRows = 20;

/// How well a network gives the torques of rows it may or may not have seen.
struct TorqueErrors {
  Eigen::RowVectorXd rmse_Nm;          // of each joint
  Eigen::RowVectorXd explained_share;  // 1 − squared error over variance; 0 where a torque does not change
  double mse_Nm2{};                    // of all joints
};
TorqueErrors ErrorsOf(const prediction::Ensemble& dynamics, const JointMotion& motion);

}  // namespace strainwave::analysis::joint_dynamics
