// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <complex>

/// Orders, per turn of the input shaft, at which parts of a strain wave gear vibrate, and how
/// the shaft's own lines change with speed.
namespace strainwave::analysis::model {

/// Teeth of the flexspline and of the circular spline that pass per turn of the wave generator; the circular
/// spline has two teeth more (2N and 2N + 2 at the ratio N).
inline double FlexsplineMeshOrder(double ratio) noexcept { return 2.0 * std::abs(ratio); }
inline double CircularSplineMeshOrder(double ratio) noexcept { return 2.0 * std::abs(ratio) + 2.0; }

/// A place of the flexspline meets one of the two lobes of the wave generator: it turns back by 1/N
/// meanwhile.
inline double CrackOrder(double ratio) noexcept { return 2.0 * (1.0 + 1.0 / std::abs(ratio)); }

/// Balls that pass a place of the outer (standing) and the inner (turning) race per turn of the shaft (E24).
/// @param diameter_ratio  ball / pitch diameter, times the cosine of the contact angle.
inline double OuterRaceOrder(int balls, double diameter_ratio) noexcept {
  return 0.5 * balls * (1.0 - diameter_ratio);
}
inline double InnerRaceOrder(int balls, double diameter_ratio) noexcept {
  return 0.5 * balls * (1.0 + diameter_ratio);
}

/// An unbalanced mass pulls with the square of the speed.
inline double ImbalanceGrowth(double speed, double reference_speed) noexcept {
  const double share = speed / reference_speed;
  return share * share;
}

/// Acceleration of a lightly damped oscillator whose support moves harmonically, relative to that of the
/// support: what a resonance makes of a line of the shaft that sweeps across it (docs/effects.md E15).
inline std::complex<double> ResonantGain(double angular_frequency, double natural,
                                         double damping_ratio) noexcept {
  const double x = angular_frequency / natural;
  return x * x / std::complex<double>(1.0 - x * x, 2.0 * damping_ratio * x);
}

}  // namespace strainwave::analysis::model
