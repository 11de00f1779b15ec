// SPDX-License-Identifier: Apache-2.0
#include "analysis/health/levels.h"

#include <algorithm>
#include <map>
#include <vector>

#include "analysis/decompositions.h"

namespace strainwave::analysis::health {

Eigen::MatrixXi LevelsOf(const Eigen::MatrixXd& health, int most) {
  Eigen::MatrixXi levels(health.rows(), health.cols());
  for (Eigen::Index c = 0; c < health.cols(); ++c) {
    std::map<double, int> counts;
    for (const double value : health.col(c)) ++counts[value];
    const bool each = static_cast<int>(counts.size()) <= most;
    const double share = static_cast<double>(health.rows()) / std::max(1, most / 2);
    std::map<double, int> number;
    int before = 0;
    int next = -1;
    int last = -1;
    for (const auto& [value, count] : counts) {
      // Shares by the middle of the rows that have the value.
      const int group = each ? last + 1 : static_cast<int>((before + 0.5 * count) / share);
      if (group != last) ++next;
      last = group;
      number[value] = next;
      before += count;
    }
    for (Eigen::Index i = 0; i < health.rows(); ++i) levels(i, c) = number[health(i, c)];
  }
  return levels;
}

int DistinguishableComponents(const Eigen::MatrixXd& health) {
  const Eigen::MatrixXd centred = health.rowwise() - health.colwise().mean();
  const Eigen::VectorXd values = SymmetricEigenvalues(centred.transpose() * centred);
  constexpr double kRounding = 1e-10;
  const double floor = kRounding * std::max(1e-300, values.maxCoeff());
  return static_cast<int>((values.array() > floor).count());
}

}  // namespace strainwave::analysis::health
