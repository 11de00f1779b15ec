// SPDX-License-Identifier: Apache-2.0
#include "analysis/explanation/shapley.h"

#include <bit>
#include <stdexcept>
#include <string>

namespace strainwave::analysis::explanation {

double ShapleyWeight(std::size_t players, std::size_t size) {
  // 1 / (n · C(n − 1, s)), which never leaves the range of a double.
  double weight = 1.0 / static_cast<double>(players);
  for (std::size_t k = 0; k < size; ++k)
    weight *= static_cast<double>(k + 1) / static_cast<double>(players - 1 - k);
  return weight;
}

std::vector<double> ShapleyValues(std::size_t players, std::size_t outputs,
                                  const std::function<void(Coalition, double*)>& value) {
  if (players > kMostExactPlayers)
    throw std::invalid_argument("Shapley values of " + std::to_string(players) + " players (expected " +
                                std::to_string(kMostExactPlayers) + " at most)");
  std::vector<double> weights;
  for (std::size_t size = 0; size < players; ++size) weights.push_back(ShapleyWeight(players, size));
  std::vector<double> shares(players * outputs, 0.0);
  std::vector<double> values(outputs);
  const Coalition coalitions = Coalition{1} << players;
  for (Coalition i = 0; i < coalitions; ++i) {
    const Coalition coalition = i ^ (i >> 1U);
    value(coalition, values.data());
    const auto size = static_cast<std::size_t>(std::popcount(coalition));
    // It counts for those within it as what they add to, and against those outside.
    for (std::size_t p = 0; p < players; ++p) {
      const bool within = ((coalition >> p) & 1U) != 0;
      const double weight = within ? weights[size - 1] : -weights[size];
      for (std::size_t o = 0; o < outputs; ++o) shares[p * outputs + o] += weight * values[o];
    }
  }
  return shares;
}

std::vector<double> ShapleyValues(std::size_t players, const std::function<double(Coalition)>& value) {
  return ShapleyValues(players, 1, [&](Coalition coalition, double* out) { *out = value(coalition); });
}

}  // namespace strainwave::analysis::explanation
