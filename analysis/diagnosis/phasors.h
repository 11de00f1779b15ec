// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <complex>
#include <cstddef>
#include <span>

namespace strainwave::analysis::diagnosis {

/// Product of finite numbers: the operator looks for infinities.
inline std::complex<double> Product(std::complex<double> a, std::complex<double> b) {
  return {a.real() * b.real() - a.imag() * b.imag(), a.real() * b.imag() + a.imag() * b.real()};
}

/// exp(i · order · angle) of every sample, to 2e-12: take(sample, phasor). Where samples are nearly evenly
/// spaced each is the one before, turned by nearly the same step, anew every few samples.
template <typename Take>
void ForEachPhasor(std::span<const double> angle_rad, double order, const Take& take) {
  constexpr std::size_t kFromOneTurnOn = 32;
  constexpr double kLeastTurn = 1e-3;  // rad, below which these powers are exact to 4e-14
  double step = 0.0;
  std::complex<double> turn = 1.0;
  std::complex<double> value;
  for (std::size_t i = 0; i < angle_rad.size(); ++i) {
    const double more = i > 0 ? order * (angle_rad[i] - angle_rad[i - 1] - step) : 0.0;
    if (i % kFromOneTurnOn != 0 && std::abs(more) < kLeastTurn) {
      value = Product(value, Product(turn, {1.0 - 0.5 * more * more, more * (1.0 - more * more / 6.0)}));
    } else {
      value = std::polar(1.0, order * angle_rad[i]);
      step = i + 1 < angle_rad.size() ? angle_rad[i + 1] - angle_rad[i] : 0.0;
      turn = std::polar(1.0, order * step);
    }
    take(i, value);
  }
}

}  // namespace strainwave::analysis::diagnosis
