// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>

namespace strainwave::analysis::model {

inline constexpr int kCreepElements = 3;

/// Creep under torque (docs/effects.md E22): φ goes on as ln(1 + t/t₀). A chain of Kelvin-Voigt elements,
/// one a decade, stands for the logarithm, or for a part of it with a smaller ratio; a decade of them adds
/// `share_per_decade` of the wind-up that stiffness `reference_Nm_per_rad` gives.
///
/// The literature's 1 to 3 % of wind-up (E22 [K]) is over hours; the default is that of a gear that creeps
/// little, so that ramps of 1 to 3 Nm/s see K lower by less than 0.1 %.
struct Creep {
  double share_per_decade{0.0004};
  double reference_Nm_per_rad{2.2e4};
  double fastest_s{4.0};  // time constants: this, and `ratio` times the last
  double ratio{10.0};
};

using CreepState = std::array<double, kCreepElements>;  // twist of each element, rad

/// Step factors 1 − exp(−dt/τ) for one step length.
struct CreepStep {
  std::array<double, kCreepElements> factor{};
  double compliance_rad_per_Nm{};
};
inline CreepStep MakeCreepStep(const Creep& creep, double step_s) noexcept {
  CreepStep step;
  double time_constant_s = creep.fastest_s;
  for (double& factor : step.factor) {
    factor = -std::expm1(-step_s / time_constant_s);
    time_constant_s *= creep.ratio;
  }
  step.compliance_rad_per_Nm = creep.share_per_decade * std::log10(creep.ratio) / creep.reference_Nm_per_rad;
  return step;
}

/// Exact for constant torque over the step.
inline void AdvanceCreep(const CreepStep& step, double torque_Nm, CreepState& state) noexcept {
  const double target_rad = step.compliance_rad_per_Nm * torque_Nm;
  for (std::size_t i = 0; i < kCreepElements; ++i) state[i] += step.factor[i] * (target_rad - state[i]);
}

inline double CreepTwist_rad(const CreepState& state) noexcept { return state[0] + state[1] + state[2]; }

/// A single element: under torque the twist goes on to compliance · torque with one time constant.
struct ExponentialCreepElement {
  double compliance_rad_per_Nm{};
  double time_constant_s{30.0};
};
inline double AdvancedCreep_rad(const ExponentialCreepElement& element, double torque_Nm, double step_s,
                                double creep_rad) noexcept {
  const double target_rad = element.compliance_rad_per_Nm * torque_Nm;
  return creep_rad - std::expm1(-step_s / element.time_constant_s) * (target_rad - creep_rad);
}

}  // namespace strainwave::analysis::model
