// SPDX-License-Identifier: Apache-2.0
#include "analysis/model/wear.h"

#include <algorithm>
#include <cmath>

namespace strainwave::analysis::model {

void AdvanceWear(const WearRates& rates, const WearExposure& exposure, WearState& state) noexcept {
  const double reference_torque = rates.reference_torque_Nm;
  const double load = exposure.cubed_torque_revolutions_Nm3 /
                      (reference_torque * reference_torque * reference_torque * rates.reference_revolutions);
  const double turns = exposure.input_revolutions / rates.reference_revolutions;
  const double above_K = exposure.temperature_degC - rates.reference_temperature_degC;

  const double tooth_rate = rates.tooth_running_in * (1.0 - state.run_in) +
                            rates.tooth_steady * (1.0 + rates.tooth_grease_coupling * state.grease) +
                            rates.tooth_late * state.tooth * state.tooth * state.tooth;
  state.tooth += load * std::exp2(above_K / rates.tooth_doubling_K) * tooth_rate;
  state.flexspline += load * (rates.flexspline_start + rates.flexspline_growth * state.flexspline);
  // Both of these end at one, whatever the length of the segment.
  state.run_in += (1.0 - state.run_in) * -std::expm1(-load / rates.run_in_life_share);
  state.grease += (1.0 - state.grease) *
                  -std::expm1(-turns * rates.grease_rate * std::exp2(above_K / rates.grease_doubling_K));
}

WearFactors FactorsOf(const WearEffects& effects, const WearState& state) noexcept {
  const double r = state.run_in;
  const double w = state.tooth;
  const double f = state.flexspline;
  const double g = state.grease;
  // Far beyond the reference life the shares would pass one; a spring stays a spring.
  const auto weakened = [&](double share) {
    return (1.0 - effects.run_in_stiffness * r) * std::max(0.2, 1.0 - share);
  };
  WearFactors factors;
  factors.k1 = weakened(effects.tooth_k1 * std::pow(w, 1.2) + effects.flexspline_k1 * f);
  factors.k2 = weakened(effects.tooth_k2 * w + effects.flexspline_k2 * std::pow(f, 1.4));
  factors.k3 = weakened(effects.tooth_k3 * w + effects.flexspline_k3 * std::pow(f, 1.7));
  factors.hysteresis = 1.0 + effects.tooth_hysteresis * w + effects.grease_hysteresis * g;
  const double settled = 1.0 - effects.run_in_kinematic * r;
  const double by_tooth = effects.tooth_kinematic;
  const double by_flexspline = effects.flexspline_kinematic;
  factors.kinematic = {settled * (1.0 + 0.8 * by_tooth * w),
                       settled * (1.0 + by_tooth * std::pow(w, 1.3) + by_flexspline * f * f),
                       settled * (1.0 + 2.0 * by_tooth * w * w),
                       settled * (1.0 + 2.5 * by_tooth * std::pow(w, 1.5)),
                       1.0 + by_flexspline * f,
                       1.0 + 3.0 * by_flexspline * f};
  factors.coulomb = (1.0 - effects.run_in_friction * r) *
                    (1.0 + effects.tooth_friction * w + effects.grease_friction * g * g);
  factors.viscous = 1.0 - effects.grease_viscosity * g;
  factors.load_friction =
      (1.0 - effects.run_in_friction * r) * (1.0 + effects.tooth_friction * w + effects.grease_friction * g);
  factors.flexspline_loss = 1.0 + effects.flexspline_friction * f;
  return factors;
}

}  // namespace strainwave::analysis::model
