// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <span>

#include "analysis/diagnosis/candidates.h"

/// Causes that show only together.
namespace strainwave::analysis::diagnosis {

/// Effects none of which shows while the others are still in the residual: slow ones pass together for the
/// autocorrelation of the noise. The strongest candidate as if the noise were white, the strongest beside it,
/// and so on; then what the autocorrelation of the residual explains as well, or another one's misfit, is
/// taken out again, weakest first.
std::optional<ScoredModel> FindTogether(const Judge& judge, std::span<const std::size_t> given,
                                        const ScoredModel& model, std::size_t most, double error);

/// Two causes in the place of one that mimics them together: it explains more than either, so it was found
/// first, and no exchange of one for one leads away from it. A pair that is clearly better, and no misfit of
/// what else is there, takes its place;
/// one that does as well is its rival.
/// @param beside  candidates beside the model. What shows beside a nuisance term may be one of two for which
///   it stands, though it shows nothing without the other
/// @param rivals  set to the pairs that do as well, by the cause whose place they would take
std::optional<ScoredModel> FindPair(const Judge& judge, std::span<const std::size_t> given,
                                    const ScoredModel& model, std::span<const Candidate> beside, double error,
                                    const DominatedBy& dominated, PairRivals& rivals);

}  // namespace strainwave::analysis::diagnosis
