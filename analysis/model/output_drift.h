// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

namespace strainwave::analysis::model {

/// Slow wandering of the output angle's reading against the gear: brackets and shafts that grow with
/// temperature, and what follows nothing but the time since the measurement began.
struct OutputDrift {
  double drift_rad_per_K{};
  double reference_degC{22.0};
  double rate_rad_per_s{};   // at the start
  double time_constant_s{};  // of settling to rate · time constant; 0: goes on for ever
};

inline double OutputDrift_rad(const OutputDrift& drift, double temperature_degC, double time_s) noexcept {
  const double settled_s = drift.time_constant_s > 0.0
                               ? -drift.time_constant_s * std::expm1(-time_s / drift.time_constant_s)
                               : time_s;
  return drift.drift_rad_per_K * (temperature_degC - drift.reference_degC) + drift.rate_rad_per_s * settled_s;
}

}  // namespace strainwave::analysis::model
