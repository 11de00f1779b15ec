// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace strainwave::analysis {

/// What a slowly moving signal shows of its own noise.
struct NoiseLevel {
  /// Of the white part, from the median of |second differences|, so that slopes, reversals and spikes do not
  /// count.
  double standard_deviation{};
  /// Smallest difference of neighbours that is not zero: the resolution of a quantised signal, and next to
  /// nothing for a continuous one.
  double step{};
};

/// At least 3 samples, else zero noise.
NoiseLevel EstimateNoise(std::span<const double> signal);

/// Retreat from an extreme that is a reversal of the signal and not its noise or resolution: the larger of
/// 10 standard deviations (a dwell of 10⁵ samples spans about 9) and 1.5 steps.
double ReversalThreshold(const NoiseLevel& noise);

/// Indices of single or double samples that stand off the median of their five neighbours by more than noise
/// and motion explain (8 standard deviations + 4 median steps of the record).
std::vector<std::size_t> FindSpikes(std::span<const double> signal, const NoiseLevel& noise);

/// Replaces the samples at `indices` (ascending) by the straight line between their good neighbours.
void InterpolateOver(std::span<double> signal, std::span<const std::size_t> indices);

/// Median; partially sorts its argument. 0 for an empty one, NaN where a value is.
double Median(std::vector<double> values);

/// Standard deviation of a normal distribution with the same median of |x|: 1.4826 × median(|x|).
double RobustStandardDeviation(std::span<const double> centred);

}  // namespace strainwave::analysis
