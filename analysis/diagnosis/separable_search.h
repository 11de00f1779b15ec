// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "analysis/diagnosis/separable_fit.h"

namespace strainwave::analysis::diagnosis {

constexpr int kSearchRounds = 6;  // for each start of a new cause
constexpr int kFinalRounds = 12;

/// Solutions with the last term of the set, whose shapes `before` does not have yet, one of each start and
/// the best one first; before all others those whose numbers are as the rule expects them. Behind them, where
/// there are shapes that are moved only where it pays, the starts themselves: without those shapes a search
/// leaves the place where they pay.
/// @return none if the record gives no place to start from
std::vector<SeparableSolution> SearchShapes(const SeparableModel& model, const TermSet& set,
                                            const CauseRule& rule, std::span<const double> weights,
                                            const SeparableSolution& before);

/// How many of the shapes with a known range need not be charged for.
double UnchargedShapes(const TermSet& set, const SeparableSolution& solution,
                       std::span<const double> weights);

/// Sets to zero, in the shapes of a set's terms, what is moved only where it pays.
void Rest(const TermSet& set, std::vector<std::vector<double>>& shapes);

/// Moves what is moved only where it pays if the likelihood, as of white noise, pays for it as BIC asks.
/// @param known  where such shapes were before, in the shapes of the first terms
/// @return whether it did
bool MoveWhereItPays(const SeparableModel& model, std::span<const double> weights,
                     const std::vector<std::vector<double>>& known, TermSet& set,
                     SeparableSolution& solution);

/// The best of solutions of the same terms once each has moved all that the set moves: what paid may pay more
/// for another start than for the one that was best without.
SeparableSolution BestOf(const SeparableModel& model, std::span<const double> weights, const TermSet& set,
                         const CauseRule& rule, SeparableSolution best,
                         std::span<const SeparableSolution> others);

}  // namespace strainwave::analysis::diagnosis
