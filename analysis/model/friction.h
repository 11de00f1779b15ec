// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>

#include "analysis/model/axis_motion.h"
#include "analysis/units.h"

namespace strainwave::analysis::model {

/// Friction that changes as a whole, in proportion, with temperature or with time since the measurement
/// began.
struct FrictionDrift {
  double share_per_K{};
  double reference_degC{22.0};
  double share_per_h{};
};
inline double FrictionDriftFactor(const FrictionDrift& drift, double temperature_degC,
                                  double time_s) noexcept {
  const double share = drift.share_per_K * (temperature_degC - drift.reference_degC) +
                       drift.share_per_h * (time_s / SecondsFromHours(1.0));
  return std::max(0.0, 1.0 + share);
}

/// Friction of a lubricated component set at the input shaft (docs/effects.md E8 to E13), in one law:
///
///   F(ω, T, ϑ) = [F_c + (F_s − F_c)·exp(−(ω/ω_s)²)]·p(θ) + b·|T| + flexspline loss + F_v(ϑ)·|ω|
///
/// Magnitudes: no-load 5.6 Ncm at 1000 rpm and 20 °C and b = 1.9 mNm per Nm in all, from the maker's
/// efficiencies 78 % at 34 Nm and 72.5 % at 19.6 Nm (E8, E9 [D]); of both, the flexspline takes 20 % at no
/// load and 50 % at full load (E11 [S]). A unit with seals has several times as much (E9 [S]).
struct Friction {
  double coulomb_Nm{0.025};
  double breakaway_Nm{0.036};                    // F_s
  double stribeck_speed_rad_per_s{10.0};         // E8: dip below 50 to 200 rpm [K]
  double stribeck_exponent{2.0};                 // axis_motion.h
  double viscous_floor_Nms_per_rad{2.0e-5};      // F_v at high temperature
  double viscous_at_0_degC_Nms_per_rad{4.6e-4};  // what temperature takes away, E10
  double viscous_temperature_K{20.0};  // a decade of no-load torque between −10 and 40 °C, E10 [S]
  double load_coefficient{4.6e-4};     // Nm per Nm of output torque, E9
  double flexspline_Nm{0.0112};        // loss a turn / 2π, E11
  double flexspline_load_coefficient{1.44e-3};  // Nm per Nm, E11
  double presliding_rad{0.035};                 // two degrees at the input, E12 [K]
  double periodic_share_1{0.06};                // of the Coulomb level, one per input turn, E13
  double periodic_share_2{0.09};                // two per input turn, E13
  FrictionDrift drift{};                        // of the whole law
};

/// The law at one temperature: what is left to evaluate a step.
struct FrictionAtTemperature {
  double coulomb_Nm{};
  double stribeck_Nm{};
  double inverse_stribeck_s_per_rad{};
  double stribeck_exponent{2.0};
  double viscous_Nms_per_rad{};
  double load_coefficient{};
  double constant_Nm{};
  double periodic_share_1{};
  double periodic_share_2{};
};

inline double ViscousCoefficient(const Friction& friction, double temperature_degC) noexcept {
  return friction.viscous_floor_Nms_per_rad +
         friction.viscous_at_0_degC_Nms_per_rad *
             std::exp(-temperature_degC / friction.viscous_temperature_K);
}

/// @param time_s  since the measurement began; only what drifts with time depends on it.
inline FrictionAtTemperature AtTemperature(const Friction& friction, double temperature_degC,
                                           double time_s = 0.0) noexcept {
  const double factor = FrictionDriftFactor(friction.drift, temperature_degC, time_s);
  FrictionAtTemperature at;
  at.coulomb_Nm = factor * friction.coulomb_Nm;
  at.stribeck_Nm = factor * std::max(0.0, friction.breakaway_Nm - friction.coulomb_Nm);
  at.inverse_stribeck_s_per_rad = 1.0 / friction.stribeck_speed_rad_per_s;
  at.stribeck_exponent = friction.stribeck_exponent;
  at.viscous_Nms_per_rad = factor * ViscousCoefficient(friction, temperature_degC);
  at.load_coefficient = factor * (friction.load_coefficient + friction.flexspline_load_coefficient);
  at.constant_Nm = factor * friction.flexspline_Nm;
  at.periodic_share_1 = friction.periodic_share_1;
  at.periodic_share_2 = friction.periodic_share_2;
  return at;
}

/// The level at which dry friction slips; the viscous part comes on top.
/// @param cos1, cos2  cosines of one and two times the input angle (E13).
inline double DryFriction_Nm(const FrictionAtTemperature& friction, double speed_rad_per_s,
                             double output_torque_Nm, double cos1, double cos2) noexcept {
  const double relative = speed_rad_per_s * friction.inverse_stribeck_s_per_rad;
  double level =
      friction.coulomb_Nm + friction.stribeck_Nm * StribeckShare(relative, 1.0, friction.stribeck_exponent);
  level *= 1.0 + friction.periodic_share_1 * cos1 + friction.periodic_share_2 * cos2;
  return level + friction.constant_Nm + friction.load_coefficient * std::abs(output_torque_Nm);
}

/// Friction torque at steady speed, without the periodic part; opposes the motion.
inline double SteadyFriction_Nm(const FrictionAtTemperature& friction, double speed_rad_per_s,
                                double output_torque_Nm) noexcept {
  return std::copysign(DryFriction_Nm(friction, speed_rad_per_s, output_torque_Nm, 0.0, 0.0),
                       speed_rad_per_s) +
         friction.viscous_Nms_per_rad * speed_rad_per_s;
}

}  // namespace strainwave::analysis::model
