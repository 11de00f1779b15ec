// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace strainwave::analysis::prediction {

/// Inputs that are looked at together, for instance all of one channel.
struct InputGroup {
  std::string name;
  std::vector<Eigen::Index> columns;
};

/// What it costs not to know a group of inputs.
struct Importance {
  std::string name;
  double error_rise_percent{};      // mean over the repeats
  double standard_error_percent{};  // of that mean
};

/// Permutation importance: the rise of the error when the rows of a group's columns are
/// shuffled together, the largest first. Inputs that say the same as others look unimportant: that is true
/// of the predictor, not of the quantity.
///
/// @param error_percent  of predictions from features, for instance the mean percentage error.
/// @param features  records that no fit has seen.
/// @throws std::invalid_argument if repeats < 2.
///
/// Source: Breiman (2001), Random forests, section 10.
std::vector<Importance> PermutationImportance(
    const std::function<double(const Eigen::MatrixXd& features)>& error_percent,
    const Eigen::MatrixXd& features, const std::vector<InputGroup>& groups, int repeats, std::uint64_t seed);

}  // namespace strainwave::analysis::prediction
