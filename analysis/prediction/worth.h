// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Core>

#include "analysis/prediction/samples.h"
#include "analysis/prediction/splits.h"

namespace strainwave::analysis::prediction {

/// What predictions are worth beside saying the same of every record: the mean of the training records, or
/// the commonest class of all.
struct Worth {
  double network_error_percent{};  // of all tested records (`Contestant::Error_percent`)
  double same_error_percent{};     // of saying the same
  double gain_percent{};           // mean over the groups of the second less the first
  double gain_se_percent{};        // of that mean, by how much groups differ

  /// Better by more than one standard error, the rule by which `SearchDesigns` takes a larger network.
  bool any() const { return gain_percent > gain_se_percent; }
};

/// @param groups  the tested records in groups that err each as a whole (a fold, a specimen, a segment of
///   time), with what was trained on for each; two groups or more.
/// @param predicted  of all samples; only tested rows are looked at.
/// @throws std::invalid_argument for fewer than two groups.
Worth WorthOf(const Samples& samples, const std::vector<Split>& groups, const Eigen::MatrixXd& predicted);

/// The test of one split in groups: by specimen, or, of one specimen alone, in five segments of time.
std::vector<Split> GroupsOfTest(const Samples& samples, const Split& split);

}  // namespace strainwave::analysis::prediction
