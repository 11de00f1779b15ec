// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "analysis/parallel_for.h"
#include "analysis/prediction/ensemble.h"

namespace strainwave::analysis::joint_dynamics {

/// What a fingerprint has of the attributions φ of a sample, each in units of the torque's standard
/// deviation:
///   kJoint   a number a joint: φ of its position, velocity and acceleration as one group, |φ| summed over
///   torques; kGroup   a number an input: |φ| summed over torques; kTensor  φ of each input on each torque,
///   with its sign.
/// |φ of a group| is not the sum of its inputs' |φ|: what two of its inputs take from each other cancels.
enum class Fingerprint { kJoint, kGroup, kTensor };
/// kExact: all coalitions; kKernel: Kernel SHAP; kGradients: expected gradients, for single inputs alone.
enum class Method { kExact, kKernel, kGradients };

std::string_view NameOf(Fingerprint fingerprint);
std::string_view NameOf(Method method);

struct AttributionSettings {
  Fingerprint fingerprint{Fingerprint::kJoint};
  Method method{Method::kExact};
  std::size_t coalitions{};  // of Kernel SHAP; 0: its default
  int draws{200};            // of expected gradients
  std::uint64_t seed{1};
};

/// Up to as many players all coalitions are looked at where nobody chose.
inline constexpr Eigen::Index kMostExactByDefault = 10;
/// All coalitions where there are few enough players, Kernel SHAP where there are up to 64, else gradients.
Method DefaultMethod(Fingerprint fingerprint, Eigen::Index joints);

/// As many as a fingerprint has numbers: joints, 3 joints, 3 joints · joints.
Eigen::Index SizeOf(Fingerprint fingerprint, Eigen::Index joints);
/// "joint1", …; "q1", "qd1", "qdd1", …; "q1_on_tau1", ….
std::vector<std::string> NamesOf(Fingerprint fingerprint, Eigen::Index joints);

struct Attributions {
  Eigen::MatrixXd fingerprints;    // samples × SizeOf
  Eigen::VectorXd quantity_share;  // of q, q̇ and q̈ in all |φ|; empty for kJoint
  double worst_gap{};              // of any sample and torque: f(x) − mean f(background) less the sum of φ
  double mean_standard_error{};    // of φ, where it was sampled
};

/// @param dynamics    of one member, from states to torques.
/// @param states      samples × 3 joints.
/// @param background  rows × 3 joints: what an input is like that nobody knows.
/// @throws std::invalid_argument for a method that cannot do this fingerprint.
Attributions Attribute(const prediction::Ensemble& dynamics, const Eigen::MatrixXd& states,
                       const Eigen::MatrixXd& background, const AttributionSettings& settings,
                       const ParallelFor& parallel = InTurn);

}  // namespace strainwave::analysis::joint_dynamics
