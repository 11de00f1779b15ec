// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "analysis/diagnosis/selection.h"

namespace strainwave::analysis::diagnosis {

/// Whether a cause of a model lives of samples in which another cause, or the nominal model, foretells a
/// course that hangs on more than a fit can know (Study::Doubt): once they count for less, most of its
/// likelihood ratio is gone and the rest is not beyond chance. What counts for less:
/// - all samples in doubt, by the noise's variance over that with a multiple of the doubt's square, of which
///   what the model leaves makes the most likely one;
/// - a sample that stands off by more than the noise, as far as the doubt goes;
/// - of ten events (samples in doubt side by side) the one that tells most for the cause.
/// @param without  the model without the cause, whose own doubt is not asked for.
bool IsInDoubt(const Judge& judge, const ScoredModel& model, const ScoredModel& without, std::size_t cause,
               double error_allowed);

}  // namespace strainwave::analysis::diagnosis
