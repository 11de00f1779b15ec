// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include <vector>

namespace strainwave::analysis::prediction {

/// What the filter made of one column.
struct FilteredColumn {
  bool kept{};
  Eigen::Index like{-1};  // the kept column that says the same; −1 where the column does not vary at all
  double correlation{};   // with that column
};

/// Keeps, from left to right, each column whose correlation with all that were kept before it is at most
/// `limit` in magnitude; drops what does not vary or is not finite. Source: docs/sources.md#shivam-2023,
/// section IV (|r| > 0.75 on 500 records); which of two alike columns stays is not said there: ours is the
/// one that comes first, so a caller puts the columns it would rather keep in front.
///
/// @param values  n × columns.
/// @throws std::invalid_argument if n < 3 or the limit is outside 0 … 1.
std::vector<FilteredColumn> FilterCorrelated(const Eigen::MatrixXd& values, double limit);

/// The indices of the columns that stay.
std::vector<Eigen::Index> KeptColumns(const std::vector<FilteredColumn>& columns);

}  // namespace strainwave::analysis::prediction
