// SPDX-License-Identifier: Apache-2.0
#include "analysis/reliability/degradation_path.h"

#include "analysis/arguments.h"

namespace strainwave::analysis::reliability {

void RequirePath(const DegradationPath& path) {
  constexpr std::size_t kFewestPoints = 8;
  RequireSameLength("cycle", path.cycle, "way", path.way);
  RequireAtLeast("cycle", path.cycle, kFewestPoints);
  RequireFinite("cycle", path.cycle);
  RequireFinite("way", path.way);
}

DegradationPath Binned(const DegradationPath& path, std::size_t most) {
  if (path.cycle.size() <= most) return path;
  DegradationPath binned;
  for (std::size_t k = 0; k < most; ++k) {
    const std::size_t begin = k * path.cycle.size() / most;
    const std::size_t end = (k + 1) * path.cycle.size() / most;
    double cycle = 0.0;
    double way = 0.0;
    for (std::size_t i = begin; i < end; ++i) {
      cycle += path.cycle[i];
      way += path.way[i];
    }
    binned.cycle.push_back(cycle / static_cast<double>(end - begin));
    binned.way.push_back(way / static_cast<double>(end - begin));
  }
  return binned;
}

}  // namespace strainwave::analysis::reliability
