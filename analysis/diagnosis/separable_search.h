// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "analysis/diagnosis/separable_fit.h"

namespace strainwave::analysis::diagnosis {

constexpr int kSearchRounds = 6;  // for each start of a new cause
constexpr int kFinalRounds = 12;

/// What a search for nonlinear parameters found.
struct SearchedNonlinearParameters {
  std::optional<SeparableSolution> best;  // none if the record gives no start
  /// Nonlinear parameters of all terms where other starts ended; and, where there are nonlinear parameters
  /// that are moved only where it pays, of the starts themselves: without those nonlinear parameters a search
  /// leaves the place where they pay.
  std::vector<std::vector<std::vector<double>>> others;
};

/// Searches for nonlinear parameters of the last term of the set, which `before` does not have yet. Best is
/// what has numbers as the rule expects them and leaves least.
SearchedNonlinearParameters SearchNonlinearParameters(const SeparableModel& model, const TermSet& set,
                                                      const CauseRule& rule, std::span<const double> weights,
                                                      const SeparableSolution& before);

/// How many of the nonlinear parameters with a known range need not be charged for.
double UnpenalisedParameters(const TermSet& set, const SeparableSolution& solution,
                             std::span<const double> weights);

/// Sets to zero, in the nonlinear parameters of a set's terms, what is moved only where it pays.
void Rest(const TermSet& set, std::vector<std::vector<double>>& nonlinear_parameters);

/// Moves what is moved only where it pays if the likelihood, as of white noise, pays for it as BIC asks.
/// @param known  where such nonlinear parameters were before, in the nonlinear parameters of the first terms
/// @return whether it did
bool MoveWhereItPays(const SeparableModel& model, std::span<const double> weights,
                     const std::vector<std::vector<double>>& known, TermSet& set,
                     SeparableSolution& solution);

/// The best of a solution and those from other nonlinear parameters once each has moved all that the set
/// moves: what paid may pay more for another start than for the one that was best without.
SeparableSolution BestOf(const SeparableModel& model, std::span<const double> weights, const TermSet& set,
                         const CauseRule& rule, SeparableSolution best,
                         std::span<const std::vector<std::vector<double>>> others);

}  // namespace strainwave::analysis::diagnosis
