// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>

namespace strainwave::analysis::features {

inline constexpr int kAutoregressiveOrder = 10;

/// Coefficients of x(t) = c₀ + ∑ₖ cₖ x(t−k) + ε, k = 1 … 10, by least squares over t = 10 … n − 1. Where the
/// series does not determine them (constant, a few pure tones) the solution of least norm, with singular
/// values below 1e-15 of the greatest taken as zero.
///
/// @param x  at least 21 values, which is what the 11 unknowns take.
/// @param centred  x − mean.
///
/// By normal equations from eleven lagged products where their condition leaves ten good digits, else by QR.
std::array<double, kAutoregressiveOrder + 1> AutoregressiveCoefficients(std::span<const double> x,
                                                                        std::span<const double> centred,
                                                                        double mean);

}  // namespace strainwave::analysis::features
