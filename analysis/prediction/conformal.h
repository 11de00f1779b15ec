// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include <span>

#include "analysis/prediction/splits.h"

namespace strainwave::analysis::prediction {

/// Half widths of the intervals of a predictor: prediction ± factor · spread(record).
struct ConformalBand {
  double coverage{};          // nominal share of new records inside
  Eigen::RowVectorXd factor;  // one an output
  /// With too few groups no finite width has a guarantee; the widest error seen stands in for it then.
  bool guaranteed{};
};

/// Split-conformal calibration on records that no fit has seen, in groups (reducers; blocks of time where
/// there is one reducer): a new record comes from a new group, and records of one group share their error, so
/// each group has the same weight whatever its length.
///
/// @param actual, predicted, spread  n × outputs; spread > 0 says how sure the predictor was of each.
/// @param group  n.
/// @param coverage  between 0 and 1.
/// @throws std::invalid_argument if shapes differ, a spread is not positive or the coverage is outside.
///
/// Source: Lee, Barber & Willett (2023), Distribution-free inference with hierarchical data, for the weights
/// 1/(G + 1) a group and 1/(G + 1) at infinity; Lei et al. (2018) for errors divided by a spread.
ConformalBand CalibrateBand(const Eigen::MatrixXd& actual, const Eigen::MatrixXd& predicted,
                            const Eigen::MatrixXd& spread, std::span<const int> group, double coverage);

/// Share of the records inside, one an output.
Eigen::RowVectorXd CoverageOf(const ConformalBand& band, const Eigen::MatrixXd& actual,
                              const Eigen::MatrixXd& predicted, const Eigen::MatrixXd& spread);

/// The same of each fold's records by a band that the others alone calibrated: what the intervals are worth
/// on a reducer that was not there.
/// @param folds  each record is tested once.
Eigen::RowVectorXd LeftOutCoverage(const Eigen::MatrixXd& actual, const Eigen::MatrixXd& predicted,
                                   const Eigen::MatrixXd& spread, std::span<const int> group,
                                   std::span<const Split> folds, double coverage);

}  // namespace strainwave::analysis::prediction
