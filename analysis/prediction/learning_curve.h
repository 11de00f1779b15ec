// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include <vector>

#include "analysis/prediction/fit_predictor.h"

namespace strainwave::analysis::prediction {

/// Errors on the records of a test after training on `count` of the others.
struct LearningPoint {
  Eigen::Index count{};
  double active_percent{};  // chosen by what is far from all chosen (`informative_records.h`)
  double even_percent{};    // spread evenly over the records in their order
};

/// How few measured records are enough: one network a point (no ensemble), for 20 records and twice as many
/// each time, up to all on the training side.
/// The error is the mean percentage error of all outputs; of classes, the share given a wrong one.
/// @param settings  `parallel` spreads the trainings.
std::vector<LearningPoint> LearningCurve(const Samples& samples, const Split& split,
                                         const EnsembleSettings& settings, const FitProgress& progress = {});

}  // namespace strainwave::analysis::prediction
