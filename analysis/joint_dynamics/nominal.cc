// SPDX-License-Identifier: Apache-2.0
#include "analysis/joint_dynamics/nominal.h"

#include <fmt/format.h>

namespace strainwave::analysis::joint_dynamics {

using Eigen::Index;

std::vector<std::string> NominalNames(Fingerprint fingerprint, Index joints) {
  std::vector<std::string> names;
  for (Index j = 1; j <= joints; ++j) names.push_back(fmt::format("off_tau{}", j));
  for (Index j = 1; j <= joints; ++j) names.push_back(fmt::format("against_tau{}", j));
  for (std::string& name : NamesOf(fingerprint, joints)) names.push_back(std::move(name));
  return names;
}

Eigen::MatrixXd NominalFingerprints(const prediction::Ensemble& nominal, const JointMotion& motion,
                                    const Eigen::MatrixXd& attributions) {
  const Index joints = motion.joints();
  // A tenth of the velocities' deviation is near standstill.
  constexpr double kNear = 0.1;
  const Eigen::MatrixXd errors = (motion.torques_Nm - nominal.Predict(motion.states).mean).array().rowwise() /
                                 nominal.output.scale.array();
  const Eigen::RowVectorXd near = kNear * nominal.input.scale.segment(joints, joints);
  const Eigen::ArrayXXd velocity = motion.states.middleCols(joints, joints);
  const Eigen::ArrayXXd sign = (velocity.rowwise() / near.array()).tanh();
  Eigen::MatrixXd fingerprints(motion.size(), 2 * joints + attributions.cols());
  fingerprints.leftCols(joints) = errors.cwiseAbs();
  fingerprints.middleCols(joints, joints) = errors.array() * sign;
  fingerprints.rightCols(attributions.cols()) = attributions;
  return fingerprints;
}

std::vector<std::vector<Index>> ColumnsOfJoints(Fingerprint fingerprint, Index joints) {
  std::vector<std::vector<Index>> columns;
  for (Index j = 0; j < joints; ++j) {
    std::vector<Index> own{j, joints + j};
    if (fingerprint == Fingerprint::kJoint) {
      own.push_back(2 * joints + j);
    } else {
      const Index each = fingerprint == Fingerprint::kTensor ? joints : 1;
      for (Index quantity = 0; quantity < 3; ++quantity) {
        for (Index k = 0; k < each; ++k) own.push_back(2 * joints + (quantity * joints + j) * each + k);
      }
    }
    columns.push_back(std::move(own));
  }
  return columns;
}

}  // namespace strainwave::analysis::joint_dynamics
