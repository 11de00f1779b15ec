// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>
#include <span>
#include <vector>

#include "analysis/torsional_stiffness.h"

namespace strainwave::analysis {

/// Parameters of the loop model as the solver sees them: logarithms keep stiffness, friction and yield twist
/// positive, the element's first state is held within ±W (beyond, it has no effect and the solver leaves it
/// there).
enum StiffnessParameter : int {
  kLogK1,
  kLogK2,
  kLogK3,
  kLogFriction,    // ln W
  kLogYieldTwist,  // ln δ
  kStartShare,     // s: the element starts at W s, −1 ≤ s ≤ 1
  kTwistOffset,    // φ₀ / twist_scale_rad
  kStiffnessParameters
};

using StiffnessParameters = Eigen::Matrix<double, kStiffnessParameters, 1>;

/// Which of the two measured signals goes into the model; the other one is what it predicts. The noise of the
/// one that goes in is not seen by least squares and biases the slopes, so it should be the cleaner one.
enum class LoopDrive { kTwist, kTorque };

/// Residuals (model − measured, in Nm, times the weight's root) of the model documented at FitStiffnessModel,
/// and their Jacobian by forward sensitivities; the interface is that of ceres::TinySolver. Driven by torque,
/// the residual is that of the twist times `torque_per_twist_Nm_per_rad`.
struct StiffnessCurve {
  using Scalar = double;
  enum { NUM_RESIDUALS = Eigen::Dynamic, NUM_PARAMETERS = kStiffnessParameters };

  std::span<const double> torque_Nm;
  std::span<const double> twist_rad;
  /// The signal that goes in, made monotone between its reversals: twist or torque, as `drive` says.
  std::span<const double> monotone_input;
  std::span<const double> weight_root;  // one a sample, or empty: all one
  TestTorques torques;
  double twist_scale_rad{1.0};
  double torque_per_twist_Nm_per_rad{1.0};
  LoopDrive drive{LoopDrive::kTwist};

  int NumResiduals() const { return static_cast<int>(torque_Nm.size()); }

  /// `jacobian` is column-major, samples × parameters, or null.
  bool operator()(const double* parameters, double* residuals, double* jacobian) const;

  /// Model torque at the measured twist, whatever drives the fit. `twist_input` as `monotone_input` for
  /// kTwist.
  std::vector<double> TorqueAtTwist(const StiffnessParameters& parameters,
                                    std::span<const double> twist_input) const;

 private:
  void DriveByTwist(const double* parameters, double* residuals, double* jacobian) const;
  void DriveByTorque(const double* parameters, double* residuals, double* jacobian) const;
};

}  // namespace strainwave::analysis
