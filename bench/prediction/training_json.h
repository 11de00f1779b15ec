// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "analysis/prediction/ensemble.h"
#include "bench/prediction/train_predictor.h"

namespace strainwave::bench {

/// What a predictor's folder and its card say of the training: sources, design, filter, errors, one object.
std::string TrainingJson(const TrainingData& data, const TrainingJob& job,
                         const analysis::prediction::EnsembleSettings& settings,
                         const TrainingOutcome& outcome);

}  // namespace strainwave::bench
