// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>

#include "analysis/wavelets/border.h"
#include "analysis/wavelets/filter_bank.h"

/// One level of the discrete wavelet transform and back. Nothing is allocated; calls may run side by side.
namespace strainwave::analysis::wavelets {

/// Coefficients of each kind that a signal of n samples gives: ⌈n/2⌉ by periodization, else ⌊(n + F − 1)/2⌋.
std::size_t CoefficientCount(std::size_t samples, std::size_t filter_length, Border border);

/// Samples that `coefficients` of each kind give back: 2 m by periodization, else 2 m − F + 2.
std::size_t SampleCount(std::size_t coefficients, std::size_t filter_length, Border border);

/// Approximation and detail of a signal: aᵢ = Σⱼ hⱼ x(2i + s − j), d alike with the high-pass; s = 1, by
/// periodization F/2.
///
/// @param signal  at least one sample.
/// @param approximation, detail  `CoefficientCount` values each, or none to leave that one out; apart from
///   the signal.
/// @throws std::invalid_argument if the signal is empty or another number of values is given.
///
/// Source: Mallat, A Wavelet Tour of Signal Processing (2009), section 7.3; borders as in PyWavelets.
void Transform(std::span<const double> signal, const FilterBank& bank, Border border,
               std::span<double> approximation, std::span<double> detail);

/// The signal again: the exact inverse, but for an odd length, which comes back one sample longer.
///
/// @param approximation, detail  of equal length; long enough for a sample by `SampleCount`.
/// @param signal  `SampleCount` values, apart from the coefficients.
/// @throws std::invalid_argument if lengths do not fit.
void InverseTransform(std::span<const double> approximation, std::span<const double> detail,
                      const FilterBank& bank, Border border, std::span<double> signal);

}  // namespace strainwave::analysis::wavelets
