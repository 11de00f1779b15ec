// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bench/prediction/train_predictor.h"

namespace strainwave::bench {

/// Prints what a training came to: features, the search, errors on each split, folds, intervals or confusion,
/// the learning curve, what the inputs are worth, and notes.
void PrintTrainingReport(const TrainingData& data, const TrainingOutcome& outcome);

}  // namespace strainwave::bench
