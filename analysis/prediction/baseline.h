// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "analysis/prediction/samples.h"

namespace strainwave::analysis::prediction {

/// What a reducer was like at its first measurements: the means over them.
struct Baseline {
  Eigen::RowVectorXd features;
  Eigen::RowVectorXd values;  // one an output
};

/// The same records told as changes since each reducer's first `records` of them, by cycle, which make up its
/// baseline and are left out: features and targets are differences, and `origin` has what to add to a target.
/// How stiff and how loud a reducer is by birth, which says nothing about its wear, falls out.
/// @throws std::invalid_argument for classes, records below 1, or a reducer that has no more than `records`.
Samples SinceBaseline(const Samples& samples, int records);

/// The means over rows of features and values.
/// @throws std::invalid_argument if there is no row.
Baseline BaselineOf(const Eigen::MatrixXd& features, const Eigen::MatrixXd& values);

}  // namespace strainwave::analysis::prediction
