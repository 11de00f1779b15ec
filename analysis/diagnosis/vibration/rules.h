// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "analysis/diagnosis/study.h"
#include "analysis/diagnosis/vibration/samples.h"
#include "analysis/diagnosis/vibration/starts.h"

namespace strainwave::analysis::diagnosis {

/// What these records can show: causes first, then nuisance terms. Says in the samples' warnings which causes
/// they cannot.
struct VibrationRules {
  std::vector<VibrationCause> kinds;
  std::vector<CauseRule> rules;
};
VibrationRules RulesFor(VibrationSamples& samples);

}  // namespace strainwave::analysis::diagnosis
