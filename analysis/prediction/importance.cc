// SPDX-License-Identifier: Apache-2.0
#include "analysis/prediction/importance.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>
#include <stdexcept>

#include "analysis/shuffle.h"

namespace strainwave::analysis::prediction {

std::vector<Importance> PermutationImportance(
    const std::function<double(const Eigen::MatrixXd& features)>& error_percent,
    const Eigen::MatrixXd& features, const std::vector<InputGroup>& groups, int repeats, std::uint64_t seed) {
  if (repeats < 2) throw std::invalid_argument(fmt::format("repeats = {} (expected at least 2)", repeats));
  const double known_percent = error_percent(features);
  std::mt19937_64 engine(seed);
  std::vector<Eigen::Index> order(static_cast<std::size_t>(features.rows()));
  std::vector<Importance> importances;
  for (const InputGroup& group : groups) {
    double sum = 0.0;
    double squares = 0.0;
    for (int repeat = 0; repeat < repeats; ++repeat) {
      std::iota(order.begin(), order.end(), Eigen::Index{0});
      Shuffle(order, engine);
      Eigen::MatrixXd shuffled = features;
      for (const Eigen::Index column : group.columns) shuffled.col(column) = features(order, column);
      const double rise = error_percent(shuffled) - known_percent;
      sum += rise;
      squares += rise * rise;
    }
    const double n = repeats;
    const double variance = std::max(0.0, squares - sum * sum / n) / (n - 1.0);
    importances.push_back({group.name, sum / n, std::sqrt(variance / n)});
  }
  std::stable_sort(importances.begin(), importances.end(), [](const Importance& a, const Importance& b) {
    return a.error_rise_percent > b.error_rise_percent;
  });
  return importances;
}

}  // namespace strainwave::analysis::prediction
