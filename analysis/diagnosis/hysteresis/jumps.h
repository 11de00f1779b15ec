// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace strainwave::analysis::diagnosis {

/// Weighted sums of a residual, and of the weights, up to each sample, and to the end.
struct RunningSums {
  std::vector<double> sum;
  std::vector<double> weight;
};
RunningSums RunningSumsOf(std::span<const double> weights, std::span<const double> residual);

/// Samples at which the residual's mean changes most, at least a fiftieth of them apart. A nearby segment
/// either side counts, since fits have taken off what lasts.
std::vector<std::size_t> BestJumps(std::span<const double> weights, std::span<const double> residual,
                                   std::size_t count);

}  // namespace strainwave::analysis::diagnosis
