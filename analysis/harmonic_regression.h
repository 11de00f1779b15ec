// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "analysis/linear_regression.h"
#include "analysis/transmission_error.h"

namespace strainwave::analysis {

/// One fitted harmonic A cos(order · θ − phase).
struct Harmonic {
  double order{};
  Estimate amplitude;
  Estimate phase_rad;  // in (−π, π]; its error is capped at π, where the phase is not known
};

/// A constant and harmonics of given orders over an angle.
struct HarmonicFit {
  Estimate constant;
  std::vector<Harmonic> harmonics;       // in the order asked for
  std::vector<double> residuals;         // measured − fitted
  double residual_standard_deviation{};  // with the degrees of freedom taken off
};

/// Least squares of y ≈ c + Σ Aₖ cos(oₖ θ − pₖ), for any real orders and any spacing of the angles. Two
/// orders that the angles cannot tell apart share their amplitude arbitrarily: fold them first (FoldedOrder).
/// Errors of an amplitude are those along its phase; an amplitude near zero has a Rayleigh, not a normal,
/// distribution.
///
/// @param errors  kAutocorrelated for samples in time order whose noise may be coloured.
/// @throws std::invalid_argument if lengths differ, a value or order is not finite, an order is not positive,
/// or there are
///   fewer than 2 · orders + 2 samples.
HarmonicFit FitHarmonics(std::span<const double> angle_rad, std::span<const double> values,
                         std::span<const double> orders, ErrorModel errors = ErrorModel::kAutocorrelated);

/// Value of the fit at an angle.
double HarmonicValue(const HarmonicFit& fit, double angle_rad);

/// Order at which a line appears that is sampled `samples_per_rev` times per revolution in equal steps:
/// within [0, samples_per_rev / 2]. With 1° steps order 320 appears at 40.
double FoldedOrder(double order, double samples_per_rev);

/// Amplitude at every integer order from 0 (the mean's size) to the last one below Nyquist, or `max_order` if
/// that is less: each order projected on its own. For pictures, and for finding lines; FitHarmonics measures
/// them.
///
/// @param angle_rad  samples over whole revolutions.
std::vector<double> IntegerOrderSpectrum(std::span<const double> angle_rad, std::span<const double> values,
                                         int max_order = 400);

}  // namespace strainwave::analysis
