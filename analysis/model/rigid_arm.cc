// SPDX-License-Identifier: Apache-2.0
#include "analysis/model/rigid_arm.h"

#include <cmath>
#include <stdexcept>

#include <Eigen/Geometry>

namespace strainwave::analysis::model {
namespace {

using Eigen::Vector3d;

// From frame i − 1 to frame i, for a vector in frame i.
Eigen::Matrix3d RotationOf(const ArmLink& link, double position_rad) {
  const double c = std::cos(position_rad);
  const double s = std::sin(position_rad);
  const double ca = std::cos(link.twist_rad);
  const double sa = std::sin(link.twist_rad);
  Eigen::Matrix3d rotation;
  rotation << c, -s * ca, s * sa, s, c * ca, -c * sa, 0.0, sa, ca;
  return rotation;
}

// What a link does on its way, in its own frame.
struct LinkMotion {
  Eigen::Matrix3d rotation;
  Vector3d to_frame;  // from frame i − 1
  Vector3d force_N;
  Vector3d moment_Nm;
};

}  // namespace

std::vector<double> InverseDynamics_Nm(std::span<const ArmLink> links, std::span<const double> position_rad,
                                       std::span<const double> velocity_rad_per_s,
                                       std::span<const double> acceleration_rad_per_s2,
                                       double gravity_m_per_s2) {
  const std::size_t joints = links.size();
  if (position_rad.size() != joints || velocity_rad_per_s.size() != joints ||
      acceleration_rad_per_s2.size() != joints)
    throw std::invalid_argument("positions, velocities and accelerations differ in number from the links");
  const Vector3d axis = Vector3d::UnitZ();
  Vector3d turning = Vector3d::Zero();
  Vector3d turning_rate = Vector3d::Zero();
  // A base that rises with g is one that stands in gravity.
  Vector3d acceleration = gravity_m_per_s2 * axis;
  std::vector<LinkMotion> motions;
  for (std::size_t i = 0; i < joints; ++i) {
    const ArmLink& link = links[i];
    LinkMotion motion;
    motion.rotation = RotationOf(link, position_rad[i]);
    motion.to_frame = {link.length_m, link.offset_m * std::sin(link.twist_rad),
                       link.offset_m * std::cos(link.twist_rad)};
    const Vector3d own = velocity_rad_per_s[i] * axis;
    const Eigen::Matrix3d back = motion.rotation.transpose();
    turning_rate = back * (turning_rate + acceleration_rad_per_s2[i] * axis + turning.cross(own));
    turning = back * (turning + own);
    acceleration = turning_rate.cross(motion.to_frame) + turning.cross(turning.cross(motion.to_frame)) +
                   back * acceleration;
    const Vector3d of_centre =
        turning_rate.cross(link.centre_m) + turning.cross(turning.cross(link.centre_m)) + acceleration;
    motion.force_N = link.mass_kg * of_centre;
    motion.moment_Nm = link.inertia_kgm2.cwiseProduct(turning_rate) +
                       turning.cross(Vector3d(link.inertia_kgm2.cwiseProduct(turning)));
    motions.push_back(motion);
  }
  std::vector<double> torques_Nm(joints);
  Vector3d force = Vector3d::Zero();  // of link i + 1 on link i, in frame i
  Vector3d moment = Vector3d::Zero();
  for (std::size_t i = joints; i-- > 0;) {
    const LinkMotion& motion = motions[i];
    const ArmLink& link = links[i];
    moment += motion.to_frame.cross(force) + (motion.to_frame + link.centre_m).cross(motion.force_N) +
              motion.moment_Nm;
    force += motion.force_N;
    force = motion.rotation * force;
    moment = motion.rotation * moment;
    torques_Nm[i] = moment.dot(axis) + link.ratio * link.ratio * link.rotor_kgm2 * acceleration_rad_per_s2[i];
  }
  return torques_Nm;
}

std::vector<ArmLink> WithPayload(std::vector<ArmLink> links, double mass_kg, double distance_m) {
  if (links.empty() || !(mass_kg >= 0.0))
    throw std::invalid_argument("a payload needs a link and a mass from 0 up");
  ArmLink& hand = links.back();
  const double together_kg = hand.mass_kg + mass_kg;
  if (together_kg <= 0.0) return links;
  const Vector3d at{0.0, 0.0, distance_m};
  const Vector3d apart = at - hand.centre_m;
  const double reduced_kg = hand.mass_kg * mass_kg / together_kg;
  hand.inertia_kgm2 += reduced_kg * Vector3d(apart.y() * apart.y() + apart.z() * apart.z(),
                                             apart.x() * apart.x() + apart.z() * apart.z(),
                                             apart.x() * apart.x() + apart.y() * apart.y());
  hand.centre_m += mass_kg / together_kg * apart;
  hand.mass_kg = together_kg;
  return links;
}

}  // namespace strainwave::analysis::model
