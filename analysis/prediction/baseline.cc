// SPDX-License-Identifier: Apache-2.0
#include "analysis/prediction/baseline.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <stdexcept>

namespace strainwave::analysis::prediction {

Baseline BaselineOf(const Eigen::MatrixXd& features, const Eigen::MatrixXd& values) {
  if (features.rows() == 0) throw std::invalid_argument("features has no row (expected one or more)");
  return {features.colwise().mean(), values.colwise().mean()};
}

Samples SinceBaseline(const Samples& samples, int records) {
  if (samples.classes) throw std::invalid_argument("classes have no baseline (expected quantities)");
  if (records < 1) {
    throw std::invalid_argument(fmt::format("records = {} (expected at least 1)", records));
  }
  std::map<int, std::vector<Eigen::Index>> lives;
  for (Eigen::Index row = 0; row < samples.size(); ++row) {
    lives[samples.specimen[static_cast<std::size_t>(row)]].push_back(row);
  }
  std::map<int, Baseline> baselines;
  std::vector<Eigen::Index> later;
  for (auto& [specimen, life] : lives) {
    if (life.size() <= static_cast<std::size_t>(records)) {
      throw std::invalid_argument(fmt::format(
          "a reducer has {} records (expected more than the {} of its baseline)", life.size(), records));
    }
    std::ranges::stable_sort(life, {},
                             [&](Eigen::Index row) { return samples.cycle[static_cast<std::size_t>(row)]; });
    const std::vector<Eigen::Index> first(life.begin(), life.begin() + records);
    baselines.emplace(specimen,
                      BaselineOf(samples.features(first, Eigen::all), samples.targets(first, Eigen::all)));
    later.insert(later.end(), life.begin() + records, life.end());
  }
  std::ranges::sort(later);
  Samples changes = Rows(samples, later);
  changes.origin.resizeLike(changes.targets);
  for (Eigen::Index row = 0; row < changes.size(); ++row) {
    const Baseline& baseline = baselines.at(changes.specimen[static_cast<std::size_t>(row)]);
    changes.features.row(row) -= baseline.features;
    changes.targets.row(row) -= baseline.values;
    changes.origin.row(row) = baseline.values;
  }
  return changes;
}

}  // namespace strainwave::analysis::prediction
