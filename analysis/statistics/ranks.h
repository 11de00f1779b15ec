// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

namespace strainwave::analysis::statistics {

/// Ranks from 1 up; values that are equal share the mean of the ranks that they take (mid-ranks).
std::vector<double> MidRanks(std::span<const double> values);

/// Product-moment correlation, −1 to 1; 0 where a side does not vary.
/// @throws std::invalid_argument if the lengths differ.
double PearsonCorrelation(std::span<const double> x, std::span<const double> y);

/// Pearson's correlation of the mid-ranks, which is right with any number of ties; 0 where a side does not
/// vary. (The short formula by squared differences of ranks is not.)
double SpearmanCorrelation(std::span<const double> x, std::span<const double> y);

}  // namespace strainwave::analysis::statistics
