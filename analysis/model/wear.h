// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "analysis/model/kinematic_error.h"

namespace strainwave::analysis::model {

/// Hidden state of a specimen's life (docs/effects.md E23). Each is 0 when new and never falls; about 1 is
/// the end of the life test of docs/sources.md#shivam-2023 (1750 h at 40 Nm and 2400 rpm).
struct WearState {
  double run_in{};
  double tooth{};
  double flexspline{};
  double grease{};
};

/// How fast the states move. That stiffness falls, and lost motion and transmission error rise, is confirmed
/// (E23 [S]); the numbers are general knowledge [K].
struct WearRates {
  double reference_torque_Nm{40.0};
  double reference_revolutions{1750.0 * 60.0 * 2400.0};
  double reference_temperature_degC{50.0};
  double run_in_life_share{0.02};  // of the reference exposure
  double tooth_running_in{5.0};    // rates per reference exposure: at first …
  double tooth_steady{0.55};       // … in the flat of the bathtub …
  double tooth_late{0.8};          // … and with the wear cubed
  double tooth_grease_coupling{0.6};
  double tooth_doubling_K{20.0};
  double flexspline_start{0.5};
  double flexspline_growth{1.0};
  double grease_rate{1.1};
  double grease_doubling_K{12.0};
};

/// What a segment of running did to the gear.
struct WearExposure {
  double input_revolutions{};
  double cubed_torque_revolutions_Nm3{};  // ∑ |T|³ · revolutions
  double temperature_degC{};
};

/// Moves the states on. Load counts with its cube (bearing and tooth life, docs/effects.md#bearing-life),
/// temperature doubles tooth wear and grease ageing; the fatigue of the flexspline does not know it.
void AdvanceWear(const WearRates& rates, const WearExposure& exposure, WearState& state) noexcept;

/// What the states do, one share per unit of the state's effect. No state acts on one quantity alone and no
/// quantity follows one state alone, so that none can be read off another.
struct WearEffects {
  double run_in_stiffness{0.008};
  double tooth_k1{0.12};
  double tooth_k2{0.025};
  double tooth_k3{0.01};
  double flexspline_k1{0.02};
  double flexspline_k2{0.09};
  double flexspline_k3{0.075};
  double tooth_hysteresis{0.3};
  double grease_hysteresis{0.15};
  double run_in_kinematic{0.05};
  double tooth_kinematic{0.46};
  double flexspline_kinematic{0.15};
  double run_in_friction{0.12};
  double tooth_friction{0.10};
  double grease_friction{0.25};
  double flexspline_friction{0.2};
  double grease_viscosity{0.15};
};

/// Factors on the properties of the new gear.
struct WearFactors {
  double k1{1.0}, k2{1.0}, k3{1.0};
  double hysteresis{1.0};
  std::array<double, kKinematicOrders> kinematic{1.0, 1.0, 1.0, 1.0, 1.0, 1.0};
  double coulomb{1.0};
  double viscous{1.0};
  double load_friction{1.0};
  double flexspline_loss{1.0};
};
WearFactors FactorsOf(const WearEffects& effects, const WearState& state) noexcept;

}  // namespace strainwave::analysis::model
