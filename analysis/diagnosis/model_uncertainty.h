// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "analysis/diagnosis/selection.h"

namespace strainwave::analysis::diagnosis {

/// Whether a cause of a model lives of samples in which another cause, or the nominal model, predicts a
/// course that depends on more than a fit can know (Study::ModelUncertainty): once they count for less, most
/// of its likelihood ratio is gone and the rest is not beyond chance. What counts for less:
/// - all uncertain samples, by the noise's variance over that with a multiple of the model uncertainty's
/// square, of which
///   what the model leaves makes the most likely one;
/// - a sample that stands off by more than the noise, as far as the model uncertainty goes;
/// - of ten events (uncertain samples side by side) the one that tells most for the cause.
/// @param without  the model without the cause, whose own model uncertainty is not asked for.
bool IsUncertain(const Judge& judge, const ScoredModel& model, const ScoredModel& without, std::size_t cause,
                 double error_allowed);

}  // namespace strainwave::analysis::diagnosis
