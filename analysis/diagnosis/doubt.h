// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "analysis/diagnosis/selection.h"

namespace strainwave::analysis::diagnosis {

/// Weights of the samples where another cause of a model foretells a course that hangs on more than a fit can
/// know (Study::Doubt): the noise's variance over that variance with a multiple of the doubt's square, by
/// maximum likelihood of what the model leaves. Empty where the model is as good there as elsewhere.
/// @param without  the model without the cause, whose doubt is not asked for.
std::vector<double> WeightsInDoubt(const Judge& judge, const ScoredModel& model, const ScoredModel& without);

/// Whether a cause of a model lives of such samples, and is not beyond chance once they count for less.
bool IsInDoubt(const Judge& judge, const ScoredModel& model, const ScoredModel& without, std::size_t cause,
               double error_allowed);

}  // namespace strainwave::analysis::diagnosis
