// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "analysis/diagnosis/study.h"

namespace strainwave::analysis::diagnosis {

/// Takes the weight from single samples whose residual stands off their neighbours', but for those that come
/// again in the other passes of their angle; true if there were new ones.
bool LeaveOutSpikes(const Study& study, const ModelFit& fit, std::vector<double>& weights);

}  // namespace strainwave::analysis::diagnosis
