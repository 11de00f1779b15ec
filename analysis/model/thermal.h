// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

#include "analysis/units.h"

namespace strainwave::analysis::model {

/// Gear and housing as two heat stores in a room, and the motor as a third (docs/effects.md E10). The slow
/// time constant is about 40 min (20 to 60 [K]); at the load of paper.yaml the gear ends 28 K above the room.
struct Thermal {
  double gear_capacity_J_per_K{700.0};
  double housing_capacity_J_per_K{4000.0};
  double gear_to_housing_K_per_W{0.35};
  double housing_to_room_K_per_W{0.45};
  double motor_capacity_J_per_K{900.0};
  double motor_to_room_K_per_W{1.6};
  double motor_loss_W_per_Nm2{12.0};      // copper, at the shaft torque squared
  double share_of_friction_in_gear{1.0};  // zero: the gear does not heat
};

/// Temperature of the room: mean, and half the swing between day and night.
struct Ambient {
  double mean_degC{22.0};
  double swing_K{1.5};
  double warmest_at_s{15.0 * 3600.0};
};

inline double AmbientTemperature_degC(const Ambient& ambient, double time_s) noexcept {
  return ambient.mean_degC + ambient.swing_K * std::cos(kTwoPi * (time_s - ambient.warmest_at_s) / 86400.0);
}

struct ThermalState {
  double gear_degC{22.0};
  double housing_degC{22.0};
  double motor_degC{22.0};
};

struct HeatFlows {
  double gear_W{};
  double motor_W{};
};

/// One explicit step; at most 30 s long, a small part of the fastest time constant.
inline void AdvanceThermal(const Thermal& thermal, const HeatFlows& heat, double room_degC, double step_s,
                           ThermalState& state) noexcept {
  const double across_W = (state.gear_degC - state.housing_degC) / thermal.gear_to_housing_K_per_W;
  const double out_W = (state.housing_degC - room_degC) / thermal.housing_to_room_K_per_W;
  const double motor_out_W = (state.motor_degC - room_degC) / thermal.motor_to_room_K_per_W;
  const double gear_W = heat.gear_W * thermal.share_of_friction_in_gear;
  state.gear_degC += step_s * (gear_W - across_W) / thermal.gear_capacity_J_per_K;
  state.housing_degC += step_s * (across_W - out_W) / thermal.housing_capacity_J_per_K;
  state.motor_degC += step_s * (heat.motor_W - motor_out_W) / thermal.motor_capacity_J_per_K;
}

}  // namespace strainwave::analysis::model
