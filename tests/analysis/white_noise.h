// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <random>
#include <vector>

namespace strainwave {

/// Independent values of a standard deviation, the same for the same seed.
inline std::vector<double> WhiteNoise(std::size_t count, double standard_deviation, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal(0.0, standard_deviation);
  std::vector<double> noise(count);
  for (double& value : noise) value = normal(random);
  return noise;
}

}  // namespace strainwave
