// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <set>
#include <vector>

#include "analysis/diagnosis/selection.h"

namespace strainwave::analysis::diagnosis {

/// A cause, or a nuisance term, fitted beside a model.
struct Candidate {
  std::size_t cause{};
  ScoredModel model;
  Comparison against;
  double score{};  // BIC less what the search locations cost
};

/// Up to so many effects each nuisance term is looked at again for causes in its place: beside more of them
/// it follows what all their formulae leave.
inline constexpr std::size_t kFewEffects = 3;
/// Of BIC, within which two are as good: odds of 20 to 1.
inline constexpr double kAsGood = 6.0;
/// Share of the likelihood ratio of a cause below which another one is no rival.
inline constexpr double kNowhereNear = 0.2;
/// Standard errors from zero: a rival need not be proven, only not be excluded.
inline constexpr double kNotExcluded = 2.0;

/// @returns it fitted beside a model; its own model is not usable where that fails.
Candidate FitCandidate(const Judge& judge, const ScoredModel& model, std::size_t cause);

/// All that may stand beside a model, each fitted with it, but for those that `is_out` names; several at once
/// where `Judge::parallel` allows it.
/// @param begins  told of each fit, which may take long; from any thread, but one at a time
std::vector<Candidate> FitCandidates(
    const Judge& judge, const ScoredModel& model,
    const std::function<bool(std::size_t cause)>& is_out = [](std::size_t) { return false; },
    const std::function<void(std::size_t cause)>& begins = [](std::size_t) {});

/// The strongest first; causes stand before a nuisance term that does not lead them by enough, so that the
/// next one has its turn where the first does not pass.
void Rank(const Study& study, std::vector<Candidate>& candidates);

/// What came nowhere near the chosen one, or is a cause that could not be fitted at all, will hardly do in
/// its place later.
std::set<std::size_t> Dominated(const Study& study, const std::vector<Candidate>& candidates,
                                const Candidate& chosen, const ScoredModel& poorer);

/// Whether what it brings is beyond chance, which is cheap to say.
bool LooksPossible(const Judge& judge, const Candidate& candidate, double error);

}  // namespace strainwave::analysis::diagnosis
