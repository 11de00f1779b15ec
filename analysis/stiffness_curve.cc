// SPDX-License-Identifier: Apache-2.0
#include "analysis/stiffness_curve.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace strainwave::analysis {
namespace {

// Torque of the spring at a twist from its centre, with its derivatives.
struct SpringPoint {
  double torque_Nm{};
  double slope_Nm_per_rad{};
  double by_log_k1{};
  double by_log_k2{};
  double by_log_k3{};

  StiffnessParameters Gradient() const {
    StiffnessParameters gradient = StiffnessParameters::Zero();
    gradient[kLogK1] = by_log_k1;
    gradient[kLogK2] = by_log_k2;
    gradient[kLogK3] = by_log_k3;
    return gradient;
  }
};

struct Spring {
  double k1, k2, k3;         // Nm/rad
  double t1, t2;             // Nm
  double break1, break2;     // rad
  double break1_shift_k2;    // K₂ · break1: by how much segment 2 moves with ln K₁
  double break1_shift_k3;    // K₃ · break1
  double segment2_shift_k3;  // K₃ · (break2 − break1): by how much segment 3 moves with ln K₂

  Spring(const double* p, const TestTorques& torques)
      : k1(std::exp(p[kLogK1])),
        k2(std::exp(p[kLogK2])),
        k3(std::exp(p[kLogK3])),
        t1(torques.t1_Nm),
        t2(torques.t2_Nm),
        break1(t1 / k1),
        break2(break1 + (t2 - t1) / k2),
        break1_shift_k2(k2 * break1),
        break1_shift_k3(k3 * break1),
        segment2_shift_k3(k3 * (break2 - break1)) {}

  SpringPoint At(double twist_rad) const {
    const double sign = twist_rad < 0.0 ? -1.0 : 1.0;
    const double size = std::abs(twist_rad);
    if (size <= break1) {
      return {k1 * twist_rad, k1, k1 * twist_rad, 0.0, 0.0};
    }
    if (size <= break2) {
      const double beyond = k2 * (size - break1);
      return {sign * (t1 + beyond), k2, sign * break1_shift_k2, sign * beyond, 0.0};
    }
    const double beyond = k3 * (size - break2);
    return {sign * (t2 + beyond), k3, sign * break1_shift_k3, sign * segment2_shift_k3, sign * beyond};
  }

  // Twist at which this spring and a linear one beside it carry a torque.
  double TwistAt(double torque_Nm, double parallel_Nm_per_rad) const {
    const double sign = torque_Nm < 0.0 ? -1.0 : 1.0;
    const double size = std::abs(torque_Nm);
    const double at_break1 = t1 + parallel_Nm_per_rad * break1;
    if (size <= at_break1) {
      return torque_Nm / (k1 + parallel_Nm_per_rad);
    }
    const double at_break2 = t2 + parallel_Nm_per_rad * break2;
    if (size <= at_break2) {
      return sign * (break1 + (size - at_break1) / (k2 + parallel_Nm_per_rad));
    }
    return sign * (break2 + (size - at_break2) / (k3 + parallel_Nm_per_rad));
  }
};

// State of the friction element as a share of W, with its derivatives.
struct FrictionState {
  double share;
  double by_log_yield{0.0};
  double by_start;

  explicit FrictionState(double start_share)
      : share(std::clamp(start_share, -1.0, 1.0)), by_start(std::abs(start_share) < 1.0 ? 1.0 : 0.0) {}

  void Move(double yields) {  // by that many yield twists
    share += yields;
    by_log_yield -= yields;
    if (share > 1.0 || share < -1.0) {
      share = share > 0.0 ? 1.0 : -1.0;
      by_log_yield = 0.0;
      by_start = 0.0;
    }
  }
};

}  // namespace

bool StiffnessCurve::operator()(const double* parameters, double* residuals, double* jacobian) const {
  if (drive == LoopDrive::kTwist) {
    DriveByTwist(parameters, residuals, jacobian);
  } else {
    DriveByTorque(parameters, residuals, jacobian);
  }
  return true;
}

void StiffnessCurve::DriveByTwist(const double* parameters, double* residuals, double* jacobian) const {
  const std::size_t n = torque_Nm.size();
  const Spring spring(parameters, torques);
  const double friction_Nm = std::exp(parameters[kLogFriction]);
  const double per_yield = std::exp(-parameters[kLogYieldTwist]);
  const double offset_rad = parameters[kTwistOffset] * twist_scale_rad;
  FrictionState element(parameters[kStartShare]);
  for (std::size_t i = 0; i < n; ++i) {
    if (i > 0) {
      element.Move((monotone_input[i] - monotone_input[i - 1]) * per_yield);
    }
    const SpringPoint point = spring.At(twist_rad[i] - offset_rad);
    const double friction = friction_Nm * element.share;
    const double weight = weight_root.empty() ? 1.0 : weight_root[i];
    residuals[i] = weight * (point.torque_Nm + friction - torque_Nm[i]);
    if (jacobian != nullptr) {
      jacobian[kLogK1 * n + i] = weight * point.by_log_k1;
      jacobian[kLogK2 * n + i] = weight * point.by_log_k2;
      jacobian[kLogK3 * n + i] = weight * point.by_log_k3;
      jacobian[kLogFriction * n + i] = weight * friction;
      jacobian[kLogYieldTwist * n + i] = weight * friction_Nm * element.by_log_yield;
      jacobian[kStartShare * n + i] = weight * friction_Nm * element.by_start;
      jacobian[kTwistOffset * n + i] = -weight * point.slope_Nm_per_rad * twist_scale_rad;
    }
  }
}

// While the element sticks, its torque is c + κφ with κ = W/δ; c is all that is kept of the
// past, and changes only when the element slides. φ counts from the spring's centre.
void StiffnessCurve::DriveByTorque(const double* parameters, double* residuals, double* jacobian) const {
  const std::size_t n = torque_Nm.size();
  const Spring spring(parameters, torques);
  const double friction_Nm = std::exp(parameters[kLogFriction]);
  const double stiffness = friction_Nm * std::exp(-parameters[kLogYieldTwist]);
  const double offset_rad = parameters[kTwistOffset] * twist_scale_rad;
  StiffnessParameters twist_by = StiffnessParameters::Zero();   // derivatives of φ
  StiffnessParameters memory_by = StiffnessParameters::Zero();  // derivatives of c
  StiffnessParameters friction_by =
      StiffnessParameters::Zero();  // derivatives of the torque of the sliding element
  double memory_Nm = 0.0;
  const auto slide = [&](double input_Nm, double share, double by_start) {
    const double twist = spring.TwistAt(input_Nm - share * friction_Nm, 0.0);
    const SpringPoint point = spring.At(twist);
    friction_by[kLogFriction] = share * friction_Nm;
    friction_by[kStartShare] = by_start * friction_Nm;
    twist_by = -(point.Gradient() + friction_by) / point.slope_Nm_per_rad;
    memory_Nm = share * friction_Nm - stiffness * twist;
    memory_by = friction_by - stiffness * twist_by;
    memory_by[kLogFriction] -= stiffness * twist;
    memory_by[kLogYieldTwist] += stiffness * twist;
    return twist;
  };
  for (std::size_t i = 0; i < n; ++i) {
    double twist = 0.0;
    if (i == 0) {
      const FrictionState start(parameters[kStartShare]);
      twist = slide(monotone_input[0], start.share, start.by_start);
    } else {
      twist = spring.TwistAt(monotone_input[i] - memory_Nm, stiffness);
      const double element_Nm = memory_Nm + stiffness * twist;
      if (std::abs(element_Nm) > friction_Nm) {
        twist = slide(monotone_input[i], element_Nm > 0.0 ? 1.0 : -1.0, 0.0);
      } else if (jacobian != nullptr) {
        const SpringPoint point = spring.At(twist);
        StiffnessParameters torque_by = point.Gradient() + memory_by;
        torque_by[kLogFriction] += stiffness * twist;
        torque_by[kLogYieldTwist] -= stiffness * twist;
        twist_by = -torque_by / (point.slope_Nm_per_rad + stiffness);
      }
    }
    const double weight = (weight_root.empty() ? 1.0 : weight_root[i]) * torque_per_twist_Nm_per_rad;
    residuals[i] = weight * (twist + offset_rad - twist_rad[i]);
    if (jacobian != nullptr) {
      for (std::size_t k = 0; k < kTwistOffset; ++k) {
        jacobian[k * n + i] = weight * twist_by[static_cast<Eigen::Index>(k)];
      }
      jacobian[kTwistOffset * n + i] = weight * twist_scale_rad;
    }
  }
}

std::vector<double> StiffnessCurve::TorqueAtTwist(const StiffnessParameters& parameters,
                                                  std::span<const double> twist_input) const {
  StiffnessCurve by_twist = *this;
  by_twist.drive = LoopDrive::kTwist;
  by_twist.monotone_input = twist_input;
  by_twist.weight_root = {};
  std::vector<double> torque(torque_Nm.size());
  by_twist(parameters.data(), torque.data(), nullptr);
  for (std::size_t i = 0; i < torque.size(); ++i) {
    torque[i] += torque_Nm[i];
  }
  return torque;
}

}  // namespace strainwave::analysis
