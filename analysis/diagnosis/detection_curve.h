// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace strainwave::analysis::diagnosis {

/// Probability with which what is asked for would be found.
inline constexpr double kDetectionProbability = 0.9;

/// One planted effect: the logarithm of its size, and whether the search found it.
struct PlantedTrial {
  double ln_size{};
  bool found{};
};

/// Logarithm of the size that is found with kDetectionProbability, with a 95 % interval.
struct DetectableSize {
  double ln_size{};
  double ln_low{};
  double ln_high{};  // infinite where the trials set no upper bound
  bool reached{};    // false: no size that was tried is found so often, and the numbers above are void
};

/// The size by Bayes' rule on a grid: the probability of being found is
/// (1 − λ) Φ((x − x₉₀)/w + Φ⁻¹(0.9/(1 − λ))) of the logarithm x of the size, with x₉₀ flat over the sizes
/// tried and three octaves to either side, w of 0.1 to 1 and a share λ of 0 to 0.05 that is missed at any
/// size
/// ([Watson](docs/sources.md#watson-1983), [Kontsevich](docs/sources.md#kontsevich-1999)).
/// @param trials  one at least
DetectableSize EstimateDetectableSize(std::span<const PlantedTrial> trials);

/// Where to plant next: at even quantiles of x₉₀ by the same rule, so that what is tried converges to the
/// size asked for ([Watson](docs/sources.md#watson-1983)), ascending, none above `ln_most`.
/// @param ln_expected  about where it is expected (Laplace, scale 0.7, on a floor of a hundredth)
std::vector<double> NextLnSizes(std::span<const PlantedTrial> trials, double ln_expected, double ln_most,
                                std::size_t count);

}  // namespace strainwave::analysis::diagnosis
