// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string_view>

namespace strainwave::analysis::wavelets {

/// How a signal goes on beyond its ends; names and meaning are PyWavelets'.
enum class Border {
  kSymmetric,      // mirrored about the outer edge of the end samples: … x₁ x₀ | x₀ x₁ …
  kPeriodization,  // repeats, an odd length after doubling its last sample; fewest coefficients
  kZero,           // zeros
};

/// @throws std::invalid_argument for any other name than symmetric, periodization and zero.
Border BorderOf(std::string_view name);
std::string_view NameOf(Border border);

/// Where the sample at `index`, inside or outside, is found among the n ≥ 1 of the signal; a short signal is
/// mirrored or repeated as often as it takes. −1: a zero.
std::ptrdiff_t InsideIndex(std::ptrdiff_t index, std::ptrdiff_t n, Border border);

}  // namespace strainwave::analysis::wavelets
