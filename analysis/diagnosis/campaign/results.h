// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>

#include "analysis/diagnosis/campaign/layout.h"

namespace strainwave::analysis::diagnosis {

/// Responses of a campaign's study, one a column, unmixed and in the units of the results: row i is the
/// result `mixed_of[i]` of the cycle `cycle_of[i]`.
Eigen::MatrixXd InTheirUnits(const CampaignLayout& layout, const Eigen::MatrixXd& responses);

}  // namespace strainwave::analysis::diagnosis
