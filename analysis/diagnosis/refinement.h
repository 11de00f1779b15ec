// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>

#include "analysis/diagnosis/selection.h"

namespace strainwave::analysis::diagnosis {

/// BIC by which one model is clearly better than another with as many causes.
inline constexpr double kClearlyBetter = 2.0;

/// Whether one may be added to a model. Of nonlinear parameters without a cause four stand side by side at
/// most: what they leave a fifth makes no clearer, and beside each every further fit is slower.
bool MayStandBeside(const Study& study, const ModelFit& fit, std::size_t cause);

/// Whether a cause came nowhere near another one when that was chosen.
bool IsDominated(const DominatedBy& dominated, std::size_t cause, std::size_t other);

/// Of a model with this cause, ahead of the one without: BIC less what the search locations cost.
double ScoreOf(const Judge& judge, const ScoredModel& with, const ScoredModel& without, std::size_t cause);

/// By how much a nuisance term has to be ahead of a cause to take its place, where so much is explained.
double LeadAsked(double explained);

/// The same where both are known: our formulae are not nature's, so that a curve always follows the last few
/// percent better, but not one with half as many numbers as a cause has amounts, where these are many
/// (disturbances at several times, against one position).
double LeadAsked(double explained, const Comparison& description, const Comparison& cause);

/// Whether what a cause of a model brings may be the misfit of another one beside it
/// (CauseRule::misfit_share, and its own least_share). False for a nuisance term, which says no more than
/// that something is there.
/// @param without  the model without the cause.
bool IsMisfit(const Judge& judge, std::span<const std::size_t> given, const ScoredModel& model,
              const ScoredModel& without, std::size_t cause);

/// Whether another cause of a model that departs from its formula (law_departure.h) explains about as much as
/// this one does beside it: then that, in words.
/// @param without  the model without the cause.
std::optional<std::string> DepartureInstead(const Judge& judge, std::span<const std::size_t> given,
                                            const ScoredModel& model, const ScoredModel& without,
                                            std::size_t cause);

/// False where a cause's parameter is outside of its range: what would do then in the place of a cause that
/// the fit lacks is no explanation, and does not make that one needless.
bool IsWithinRanges(const Judge& judge, std::span<const std::size_t> given, const ModelFit& fit);

/// Fits the model anew from where a further cause had led it; true, and `model` is that, if it is a deeper
/// local minimum: what it brings is then no merit of the cause.
bool FindDeeper(const Judge& judge, const ScoredModel& with_more, ScoredModel& model);

/// Drops one cause that the rest of the model does not need any more; false where there is none.
bool DropNeedless(const Judge& judge, std::span<const std::size_t> given, const DiagnoseOptions& options,
                  ScoredModel& model);

/// Exchanges one cause for one that does better in its place and is itself beyond chance there, or for itself
/// in another form; false where there is none.
/// @param dominated  gets what did not do half as well, so as not to be tried there again.
bool Exchange(const Judge& judge, std::span<const std::size_t> given, const DiagnoseOptions& options,
              DominatedBy& dominated, ScoredModel& model, double explained);

/// Of the white likelihood ratio of a cause, from which on others may be dominated by it.
inline constexpr double kClearlyAhead = 60.0;
/// Likelihood ratio as if the noise were white: what an effect leaves of another passes for autocorrelation.
double WhiteRatio(const ScoredModel& richer, const ScoredModel& poorer);

}  // namespace strainwave::analysis::diagnosis
