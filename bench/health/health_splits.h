// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bench/health/train_health.h"

namespace strainwave::bench {

analysis::prediction::EnsembleSettings NetworkOfHealth(const HealthJob& job, Eigen::Index inputs,
                                                       Eigen::Index outputs, int hidden_nodes,
                                                       Eigen::Index rows);

/// All splits that the data allow; notes say which they do not.
std::vector<HealthSplit> TestHealth(const HealthData& data, const HealthJob& job, int hidden_nodes,
                                    const HealthProgress& progress, std::vector<std::string>& notes);

/// Root mean square error of each of 12 (or 50) numbers of nodes over five folds: of units where there are
/// five or more, else of cycles at random.
std::vector<HiddenTrial> SearchHiddenNodes(const HealthData& data, const ChosenFeatures& chosen,
                                           const HealthJob& job, const HealthProgress& progress);

}  // namespace strainwave::bench
