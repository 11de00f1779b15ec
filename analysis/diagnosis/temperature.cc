// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/temperature.h"

#include <algorithm>
#include <cstddef>

namespace strainwave::analysis::diagnosis {

std::vector<double> SlowTemperature(std::span<const double> temperature_degC) {
  const std::size_t n = temperature_degC.size();
  const std::size_t half = std::max<std::size_t>(1, n / 100);
  std::vector<double> sums{0.0};
  sums.reserve(n + 1);
  for (const double temperature : temperature_degC) sums.push_back(sums.back() + temperature);
  std::vector<double> slow;
  slow.reserve(n);
  for (std::size_t i = 0; i < n; ++i) {
    // As many on either side, also near the ends: there a drift would be pulled towards the middle.
    const std::size_t reach = std::min({half, i, n - 1 - i});
    slow.push_back((sums[i + reach + 1] - sums[i - reach]) / static_cast<double>(2 * reach + 1));
  }
  return slow;
}

}  // namespace strainwave::analysis::diagnosis
