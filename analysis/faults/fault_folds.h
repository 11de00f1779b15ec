// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "analysis/prediction/splits.h"

namespace strainwave::analysis::faults {

/// Records that are tested by what has not seen them, fold by fold.
struct FaultFolds {
  std::vector<prediction::Split> folds;
  /// In no fold's test: what they show is in no other group, so that nothing could have taught it.
  std::vector<Eigen::Index> untested;
  std::size_t groups{};  // that were left out, one or several a fold

  bool empty() const noexcept { return folds.empty(); }
};

inline constexpr int kMostFolds = 10;

/// Whole groups are left out, each once: one a fold, or dealt to ten folds where there are more, the groups
/// of one class apart. A record is tested only where its fold's training shows all that it shows; there is no
/// fold at all where that holds for none.
/// @param group  n numbers.
/// @param targets  n × classes or labels, 0 or 1.
/// @throws std::invalid_argument if lengths differ.
FaultFolds FoldsByGroup(std::span<const int> group, const Eigen::MatrixXd& targets);

/// Records dealt to `folds` at random, those of equal targets evenly.
/// @throws std::invalid_argument if there are fewer than two folds.
FaultFolds FoldsAtRandom(const Eigen::MatrixXd& targets, int folds, std::uint64_t seed);

/// One fold: trained on records with at most one label, tested on those with several.
FaultFolds SinglesToPairs(const Eigen::MatrixXd& targets);

}  // namespace strainwave::analysis::faults
