// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

namespace strainwave::analysis::model {

/// A link of a serial arm whose joints all turn, by Denavit and Hartenberg's standard frames: frame i stands
/// at the far end of link i, its z axis is that of joint i + 1.
struct ArmLink {
  double offset_m{};   // d, along the joint's axis
  double length_m{};   // a
  double twist_rad{};  // α
  double mass_kg{};
  Eigen::Vector3d centre_m{Eigen::Vector3d::Zero()};      // of mass, in frame i
  Eigen::Vector3d inertia_kgm2{Eigen::Vector3d::Zero()};  // xx, yy, zz about it; no products
  double rotor_kgm2{};                                    // of the motor, at its own shaft
  double ratio{};                                         // of the reducer; its sign does not matter here
};

inline constexpr double kGravity_m_per_s2 = 9.81;

/// The torques that hold an arm on its way, without friction: M(q) q̈ + C(q, q̇) q̇ + g(q), the rotors' inertia
/// among it. z of the base points upwards.
///
/// Recursive Newton–Euler: speeds and accelerations from the base outwards, forces and moments back.
/// @throws std::invalid_argument unless there is one of each a link.
///
/// Source: docs/sources.md#luh-1980.
std::vector<double> InverseDynamics_Nm(std::span<const ArmLink> links, std::span<const double> position_rad,
                                       std::span<const double> velocity_rad_per_s,
                                       std::span<const double> acceleration_rad_per_s2,
                                       double gravity_m_per_s2 = kGravity_m_per_s2);

/// The arm with a mass in its hand, a point on the last link's z axis.
/// @throws std::invalid_argument for an arm without links or a negative mass.
std::vector<ArmLink> WithPayload(std::vector<ArmLink> links, double mass_kg, double distance_m);

}  // namespace strainwave::analysis::model
