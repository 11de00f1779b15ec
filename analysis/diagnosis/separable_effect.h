// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

#include "analysis/diagnosis/separable_study.h"

namespace strainwave::analysis::diagnosis {

/// A separable term drawn at random: nonlinear parameters uniform in their ranges, as far as the rule's
/// ranges hold them; coefficients in a direction in which each column may bring as much; numbers of one
/// record zero. Its amount is the rule's that grows with the coefficients, or else the first number that
/// does.
/// @param samples  of the response
/// @param small  a size of the response beside which the record's noise is large: for slopes at zero
/// @returns nothing where no draw of many shows in the record within the rule's ranges
std::optional<DrawnEffect> DrawSeparableEffect(const SeparableTerm& term, const CauseRule& rule,
                                               std::size_t samples, double small, std::uint64_t draw);

}  // namespace strainwave::analysis::diagnosis
