// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

namespace strainwave::analysis::reliability {

/// How far one unit has come to its limit: 0 at its start, 1 at the limit; over cycles above zero, in order.
struct DegradationPath {
  std::vector<double> cycle;
  std::vector<double> way;
};

/// @throws std::invalid_argument for fewer than 8 points, columns of different lengths, values not finite.
void RequirePath(const DegradationPath& path);

/// By straight averages of neighbours to at most that many points.
DegradationPath Binned(const DegradationPath& path, std::size_t most);

}  // namespace strainwave::analysis::reliability
