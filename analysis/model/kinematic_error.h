// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

#include "analysis/model/local_tooth_damage.h"
#include "analysis/units.h"

namespace strainwave::analysis::model {

/// Orders of the gear's own kinematic error (docs/effects.md E1 to E4), in the order of `KinematicError`
/// below. Per input turn unless the name says output; the tooth engagement is at z_CS = 2N + 2 per output
/// turn (162), beside the 2N = 160 of the wave generator's second harmonic (E2).
enum class KinematicOrder : unsigned { kInput1, kInput2, kInput4, kTooth, kOutput1, kOutput2 };
inline constexpr int kKinematicOrders = 6;

/// A damaged tooth: what `LocalToothDamageShape` is multiplied by, and where it is.
struct LocalToothDamage {
  double height_rad{};
  double centre_rad{};                // output angle
  double width_rad{RadFromDeg(4.0)};  // full width at half height; > 0
  double skew_share{};                // of the flank towards larger angles, −1 to 1
};

/// Kinematic error e = ∑ Aₖ sin(oₖ θ + φₖ), an output angle: θ_out = θ_in/N − e at no load.
///
/// Defaults add up to a peak-to-peak of about one arcmin, the maker's limit for a standard unit (E1 [S]);
/// how it is shared between the orders is general knowledge (E1, E2, E3 [K]).
struct KinematicError {
  std::array<double, kKinematicOrders> amplitude_rad{1.8e-5, 8.0e-5, 1.4e-5, 2.0e-5, 3.0e-5, 1.2e-5};
  std::array<double, kKinematicOrders> phase_rad{0.7, 0.0, 1.9, 2.4, 0.4, 4.1};
  LocalToothDamage damage{};
};

/// Sine and cosine of input angle and of input angle / ratio: everything periodic is built from these two.
struct GearPhasors {
  double input_sin, input_cos;
  double output_sin, output_cos;
};
inline GearPhasors PhasorsAt(double input_rad, double inverse_ratio) noexcept {
  const double output_rad = input_rad * inverse_ratio;
  return {std::sin(input_rad), std::cos(input_rad), std::sin(output_rad), std::cos(output_rad)};
}

/// The same series as sine and cosine coefficients, and the orders per input turn, ready to evaluate.
struct KinematicSeries {
  std::array<double, kKinematicOrders> sine_rad{};
  std::array<double, kKinematicOrders> cosine_rad{};
  std::array<double, kKinematicOrders> order{};
  double inverse_ratio{1.0 / 80.0};
  LocalToothDamage damage{};
};
KinematicSeries CompileKinematicError(const KinematicError& error, double ratio);

/// Error at an angle and its derivative by the input angle.
struct KinematicValue {
  double error_rad;
  double derivative;  // de/dθ_in
};

/// Sine and cosine at two and four per input turn are by-products that others need too.
struct InputHarmonics {
  double sin2, cos2, sin4, cos4;
};
inline InputHarmonics HarmonicsOf(const GearPhasors& phasors) noexcept {
  const double sin2 = 2.0 * phasors.input_sin * phasors.input_cos;
  const double cos2 = 1.0 - 2.0 * phasors.input_sin * phasors.input_sin;
  return {sin2, cos2, 2.0 * sin2 * cos2, 1.0 - 2.0 * sin2 * sin2};
}

/// The orders alone.
inline KinematicValue EvaluateKinematicError(const KinematicSeries& series, const GearPhasors& phasors,
                                             const InputHarmonics& harmonics) noexcept {
  const double output_sin2 = 2.0 * phasors.output_sin * phasors.output_cos;
  const double output_cos2 = 1.0 - 2.0 * phasors.output_sin * phasors.output_sin;
  // z_CS per output turn is two per input turn plus two per output turn.
  const double tooth_sin = harmonics.sin2 * output_cos2 + harmonics.cos2 * output_sin2;
  const double tooth_cos = harmonics.cos2 * output_cos2 - harmonics.sin2 * output_sin2;
  const double sines[kKinematicOrders] = {phasors.input_sin, harmonics.sin2,     harmonics.sin4,
                                          tooth_sin,         phasors.output_sin, output_sin2};
  const double cosines[kKinematicOrders] = {phasors.input_cos, harmonics.cos2,     harmonics.cos4,
                                            tooth_cos,         phasors.output_cos, output_cos2};
  KinematicValue value{0.0, 0.0};
  for (std::size_t k = 0; k < kKinematicOrders; ++k) {
    value.error_rad += series.sine_rad[k] * sines[k] + series.cosine_rad[k] * cosines[k];
    value.derivative += series.order[k] * (series.sine_rad[k] * cosines[k] - series.cosine_rad[k] * sines[k]);
  }
  return value;
}

/// With the damaged tooth.
KinematicValue EvaluateDamagedKinematicError(const KinematicSeries& series, const GearPhasors& phasors,
                                             const InputHarmonics& harmonics) noexcept;

/// Convenience for one angle; all of it.
double KinematicErrorAt(const KinematicSeries& series, double input_rad) noexcept;

}  // namespace strainwave::analysis::model
