// SPDX-License-Identifier: Apache-2.0
#include "analysis/faults/fault_folds.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <random>
#include <set>
#include <stdexcept>

#include "analysis/shuffle.h"

namespace strainwave::analysis::faults {
namespace {

using Pattern = std::vector<bool>;

Pattern PatternOf(const Eigen::MatrixXd& targets, Eigen::Index row) {
  Pattern pattern;
  for (Eigen::Index column = 0; column < targets.cols(); ++column)
    pattern.push_back(targets(row, column) > 0.5);
  return pattern;
}

// Labels of which the training has records with and without it.
std::vector<bool> Taught(const Eigen::MatrixXd& targets, const std::vector<Eigen::Index>& train) {
  std::vector<bool> taught;
  for (Eigen::Index column = 0; column < targets.cols(); ++column) {
    const auto with =
        std::ranges::count_if(train, [&](Eigen::Index row) { return targets(row, column) > 0.5; });
    taught.push_back(with > 0 && with < static_cast<std::ptrdiff_t>(train.size()));
  }
  return taught;
}

bool IsTaught(const Pattern& pattern, const std::vector<bool>& taught) {
  for (std::size_t column = 0; column < pattern.size(); ++column) {
    if (pattern[column] && !taught[column]) return false;
  }
  return true;
}

// Of rows whose fold is known; a training that has less than two classes to tell apart is none.
FaultFolds FoldsOf(const std::vector<int>& fold_of_row, int folds, const Eigen::MatrixXd& targets) {
  FaultFolds result;
  for (int fold = 0; fold < folds; ++fold) {
    prediction::Split split;
    for (std::size_t i = 0; i < fold_of_row.size(); ++i)
      (fold_of_row[i] == fold ? split.test : split.train).push_back(static_cast<Eigen::Index>(i));
    const std::vector<bool> taught = Taught(targets, split.train);
    // Fewer rows have no covariance that tells what lies outside.
    constexpr std::size_t kFewestRows = 3;
    const bool teaches = split.train.size() >= kFewestRows && std::ranges::find(taught, true) != taught.end();
    const auto untested = std::stable_partition(split.test.begin(), split.test.end(), [&](Eigen::Index row) {
      return teaches && IsTaught(PatternOf(targets, row), taught);
    });
    result.untested.insert(result.untested.end(), untested, split.test.end());
    split.test.erase(untested, split.test.end());
    if (!split.test.empty()) result.folds.push_back(std::move(split));
  }
  std::ranges::sort(result.untested);
  return result;
}

}  // namespace

FaultFolds FoldsByGroup(std::span<const int> group, const Eigen::MatrixXd& targets) {
  if (static_cast<Eigen::Index>(group.size()) != targets.rows())
    throw std::invalid_argument(fmt::format("group has {} values, targets has {} rows (expected the same)",
                                            group.size(), targets.rows()));
  // Groups of one pattern one after the other, so that dealing them in turn sets them apart.
  std::map<int, Pattern> first;
  for (std::size_t i = 0; i < group.size(); ++i)
    first.emplace(group[i], PatternOf(targets, static_cast<Eigen::Index>(i)));
  std::vector<std::pair<Pattern, int>> order;
  for (const auto& [number, pattern] : first) order.emplace_back(pattern, number);
  std::ranges::sort(order);
  const int folds = std::min(kMostFolds, static_cast<int>(order.size()));
  if (folds < 2) return {.folds = {}, .untested = {}, .groups = order.size()};
  std::map<int, int> fold_of_group;
  int next = 0;
  for (const auto& [pattern, number] : order) fold_of_group[number] = next++ % folds;
  std::vector<int> fold_of_row;
  for (const int number : group) fold_of_row.push_back(fold_of_group[number]);
  FaultFolds result = FoldsOf(fold_of_row, folds, targets);
  result.groups = order.size();
  return result;
}

FaultFolds FoldsAtRandom(const Eigen::MatrixXd& targets, int folds, std::uint64_t seed) {
  if (folds < 2) throw std::invalid_argument(fmt::format("folds = {} (expected two or more)", folds));
  std::map<Pattern, std::vector<std::size_t>> alike;
  for (Eigen::Index row = 0; row < targets.rows(); ++row)
    alike[PatternOf(targets, row)].push_back(static_cast<std::size_t>(row));
  std::mt19937_64 engine(seed);
  std::vector<int> fold_of_row(static_cast<std::size_t>(targets.rows()));
  std::size_t next = 0;
  for (auto& [pattern, rows] : alike) {
    Shuffle(rows, engine);
    for (const std::size_t row : rows)
      fold_of_row[row] = static_cast<int>(next++ % static_cast<std::size_t>(folds));
  }
  FaultFolds result = FoldsOf(fold_of_row, folds, targets);
  result.groups = static_cast<std::size_t>(targets.rows());
  return result;
}

FaultFolds SinglesToPairs(const Eigen::MatrixXd& targets) {
  std::vector<int> fold_of_row;
  for (Eigen::Index row = 0; row < targets.rows(); ++row)
    fold_of_row.push_back(targets.row(row).sum() > 1.5 ? 0 : 1);
  // Of both directions the one that trains on the singles.
  FaultFolds result = FoldsOf(fold_of_row, 1, targets);
  result.groups = result.folds.empty() ? 0 : 1;
  return result;
}

}  // namespace strainwave::analysis::faults
