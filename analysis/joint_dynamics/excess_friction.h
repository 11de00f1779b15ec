// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

namespace strainwave::analysis::joint_dynamics {

/// Whether a file has more friction than healthy ones, told without a faulty file to learn from. Of each
/// joint t = (a − m) / (s √(1 + 1/n)), where a is the file's mean torque against the motion that the nominal
/// network does not explain, and m, s its mean and standard deviation over n healthy files; the file's score
/// is the greatest t of its joints. Student's t of n − 1 degrees of freedom where healthy files are normal
/// (prediction of one further value: docs/sources.md#nist-handbook).
struct ExcessFriction {
  Eigen::RowVectorXd mean;       // of each joint, over healthy files
  Eigen::RowVectorXd deviation;  // of one further file
  double limit{};                // which a healthy file passes by chance with 5 %, all joints together

  /// @param against  of a file, one value a joint.
  double Score(const Eigen::RowVectorXd& against) const;
};

inline constexpr Eigen::Index kFewestHealthyFiles = 3;

/// @param healthy  files × joints.
/// @throws std::invalid_argument for fewer than `kFewestHealthyFiles`.
ExcessFriction FitExcessFriction(const Eigen::MatrixXd& healthy);

/// The mean over each file's samples of the columns `against_tauJ` of nominal fingerprints (nominal.h).
/// @param fingerprints  samples × numbers.
/// @param file   of each sample, from 0.
/// @return files × joints.
Eigen::MatrixXd MeanAgainstMotion(const Eigen::MatrixXd& fingerprints, std::span<const int> file,
                                  Eigen::Index files, Eigen::Index joints);

}  // namespace strainwave::analysis::joint_dynamics
