// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>
#include <array>
#include <vector>

#include "analysis/diagnosis/hysteresis/record.h"
#include "analysis/model/backlash.h"
#include "analysis/model/elasto_plastic.h"
#include "analysis/model/torsion_spring.h"

namespace strainwave::analysis::diagnosis {

inline constexpr std::size_t kFrictionElements = 13;

/// The gear under torque, input locked:
///
///   T − T₀ = g(φ) + a φ³ + Σ zⱼ(φ) + c φ̇,
///
/// g the piecewise-linear spring (stiffer under torque of one sign by the asymmetry of each segment), zⱼ
/// elasto-plastic friction elements, T₀ the offset of the torque signal. The dead zone lies either beside the
/// friction, in series with the spring alone, or outside of both. The elements' limits and yield
/// twists are larger by rise · ln(1 + |Ṫ| / usual rate), or by rise · |Ṫ| / usual rate; the twist lags by
/// lag · Ṫ, and what the gear feels of the torque by torque lag · Ṫ.
struct GearLaw {
  model::TorsionSpring spring;
  std::array<model::ElastoPlasticElement, kFrictionElements> friction{};
  std::size_t friction_elements{1};
  /// State of each element at a record's first sample as a share of its limit, −1 to 1; one row a record.
  std::vector<std::array<double, kFrictionElements>> start_share;
  std::array<double, 3> asymmetry_share{};  // of K1, K2 and K3
  bool knees_at_twist{};                    // of both sides at the same twist; else at the same torque
  double hardening_Nm_per_rad3{};
  double viscous_Nms_per_rad{};
  double lag_rad_s_per_Nm{};
  double torque_lag_s{};
  double friction_rise_share{};
  bool friction_rises_linearly{};
  double usual_rate_Nm_per_s{1.0};
  double torque_offset_Nm{};
  model::Backlash backlash;
  bool backlash_beside_friction{};
};

/// Twist at every point of a grid. Solved exactly between kinks; a damper by small steps.
void FillTwist(const GearLaw& law, const LoopGrid& grid, Eigen::VectorXd& twist_rad);

}  // namespace strainwave::analysis::diagnosis
