// SPDX-License-Identifier: Apache-2.0
#include "analysis/prediction/worth.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>

#include "analysis/prediction/fit_predictor.h"

namespace strainwave::analysis::prediction {
namespace {

double ErrorOn_percent(const Samples& samples, const std::vector<Eigen::Index>& rows,
                       const Eigen::MatrixXd& predicted) {
  return Judge("", Rows(samples, rows), predicted(rows, Eigen::all)).Error_percent();
}

}  // namespace

Worth WorthOf(const Samples& samples, const std::vector<Split>& groups, const Eigen::MatrixXd& predicted) {
  if (groups.size() < 2)
    throw std::invalid_argument("there are fewer than two groups to tell a gain from chance");
  // Without the commonest class of the tested, one that a fold leaves out would make any guess look good.
  Eigen::MatrixXd same = samples.targets.colwise().mean().replicate(samples.size(), 1);
  std::vector<Eigen::Index> tested;
  for (const Split& group : groups) {
    tested.insert(tested.end(), group.test.begin(), group.test.end());
    if (samples.classes) continue;
    const Eigen::RowVectorXd mean = samples.targets(group.train, Eigen::all).colwise().mean();
    same(group.test, Eigen::all) = mean.replicate(static_cast<Eigen::Index>(group.test.size()), 1);
  }
  Eigen::VectorXd gains(static_cast<Eigen::Index>(groups.size()));
  for (Eigen::Index k = 0; k < gains.size(); ++k) {
    const auto& rows = groups[static_cast<std::size_t>(k)].test;
    gains(k) = ErrorOn_percent(samples, rows, same) - ErrorOn_percent(samples, rows, predicted);
  }
  const auto count = static_cast<double>(gains.size());
  const double mean = gains.mean();
  return {.network_error_percent = ErrorOn_percent(samples, tested, predicted),
          .same_error_percent = ErrorOn_percent(samples, tested, same),
          .gain_percent = mean,
          .gain_se_percent = std::sqrt((gains.array() - mean).square().sum() / (count - 1.0) / count)};
}

std::vector<Split> GroupsOfTest(const Samples& samples, const Split& split) {
  constexpr std::size_t kSegments = 5;
  std::map<int, Split> by_specimen;
  for (const Eigen::Index row : split.test)
    by_specimen[samples.specimen[static_cast<std::size_t>(row)]].test.push_back(row);
  std::vector<Split> groups;
  for (auto& [specimen, group] : by_specimen) groups.push_back(std::move(group));
  if (groups.size() == 1) {
    std::vector<Eigen::Index> rows = std::move(groups.front().test);
    std::ranges::stable_sort(rows, {},
                             [&](Eigen::Index row) { return samples.cycle[static_cast<std::size_t>(row)]; });
    const std::size_t count = std::min(kSegments, rows.size());
    groups.assign(count, {});
    for (std::size_t i = 0; i < rows.size(); ++i) groups[i * count / rows.size()].test.push_back(rows[i]);
  }
  for (Split& group : groups) group.train = split.train;
  return groups;
}

}  // namespace strainwave::analysis::prediction
