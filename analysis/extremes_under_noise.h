// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

namespace strainwave::analysis {

/// What independent normal noise does to max − min of a curve.
struct RangeUnderNoise {
  double bias{};                    // mean of max − min with noise, less max − min without
  double root_mean_square_error{};  // of max − min with noise against max − min without; includes the bias
};

/// The largest of n values fᵢ + σ εᵢ has the distribution Π Φ((x − fᵢ) / σ); its mean and variance are
/// integrated, those of the smallest likewise, and the two taken as independent (they are when far apart
/// compared with σ).
///
/// @param curve  the noise-free values, at least one.
/// @throws std::invalid_argument if `curve` is empty or σ is negative or not finite.
RangeUnderNoise ExpectRangeUnderNoise(std::span<const double> curve, double standard_deviation);

}  // namespace strainwave::analysis
