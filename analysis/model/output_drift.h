// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

#include "analysis/units.h"

namespace strainwave::analysis::model {

/// Slow wandering of the output angle's reading against the gear: brackets and shafts that grow with
/// temperature, and what follows nothing but the time since the measurement began.
struct OutputDrift {
  double drift_rad_per_K{};
  double reference_degC{22.0};
  double rate_rad_per_s{};   // at the start
  double time_constant_s{};  // of settling to rate · time constant; 0: goes on for ever
  double swing_rad{};        // to and fro, as a room's days and nights
  double swing_period_s{86400.0};
  double swing_phase_rad{};  // of its sine, when the measurement began

  bool moves() const noexcept { return drift_rad_per_K != 0.0 || rate_rad_per_s != 0.0 || swing_rad != 0.0; }
};

inline double OutputDrift_rad(const OutputDrift& drift, double temperature_degC, double time_s) noexcept {
  const double settled_s = drift.time_constant_s > 0.0
                               ? -drift.time_constant_s * std::expm1(-time_s / drift.time_constant_s)
                               : time_s;
  const double swung_rad =
      drift.swing_rad != 0.0
          ? drift.swing_rad * (std::sin(kTwoPi * time_s / drift.swing_period_s + drift.swing_phase_rad) -
                               std::sin(drift.swing_phase_rad))
          : 0.0;
  return drift.drift_rad_per_K * (temperature_degC - drift.reference_degC) +
         drift.rate_rad_per_s * settled_s + swung_rad;
}

}  // namespace strainwave::analysis::model
