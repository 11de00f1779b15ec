// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/hysteresis/unpenalised_parameters.h"

#include <algorithm>
#include <vector>

#include "analysis/diagnosis/known_before.h"

namespace strainwave::analysis::diagnosis {

using Eigen::Index;

double UnpenalisedParameters(const LoopModel& model, const LoopSolution& solution, const LoopGrid& grid) {
  const std::vector<bool> held = model.Held(solution.numbers);
  std::vector<Index> known;
  std::vector<Index> others;
  std::vector<double> ranges;
  Index next = model.nominal_size();
  for (Index k = 0; k < next; ++k) others.push_back(k);
  for (const LoopEffect* effect : model.effects()) {
    for (const FitNumber& number : effect->numbers) {
      const Index k = next++;
      if (held[static_cast<std::size_t>(k)]) continue;
      const bool is_known = effect->rule.named && !number.amount;
      (is_known ? known : others).push_back(k);
      if (is_known) ranges.push_back(number.high - number.low);
    }
  }
  if (known.empty()) return 0.0;
  Eigen::MatrixXd rows;
  model.Predict(solution.numbers, grid, rows);
  const Eigen::Map<const Eigen::VectorXd> weight(grid.weight.data(), rows.rows());
  rows = weight.cwiseSqrt().asDiagonal() * rows;
  const auto points = static_cast<double>((weight.array() > 0.0).count());
  return KnownBefore(rows(Eigen::all, known), rows(Eigen::all, others), ranges,
                     solution.cost / std::max(points, 1.0), weight.sum());
}

}  // namespace strainwave::analysis::diagnosis
