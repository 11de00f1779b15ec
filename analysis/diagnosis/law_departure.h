// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "analysis/diagnosis/study.h"

namespace strainwave::analysis::diagnosis {

/// A cause that departs from its formula: its contribution y times a polynomial of a regressor r without the
/// constant, y Σ cₖ Pₖ(r), k = 1 to 3 (Legendre, r from −1 to 1); of its own size; or Σ cₖ Δᵏy over time, k =
/// 1 and 2, as of something that lags.
struct LawDeparture {
  std::string over;        // regressor's name, "its size" or "time lag"
  double explained{};      // weighted sum of squares that it takes from the residual
  double relative_size{};  // its RMS beside what the parameters could change, over the contribution's
};

/// The departure that takes most of a model's residual, beside what all parameters of the model could change
/// (to first order). Nothing where the cause's contribution cannot be told by its parameters.
/// @param fit  of the model, for judging: its parameters with errors. @param cause  one of `fit`'s.
/// @param most_relative_size  departures that are larger do not count.
std::optional<LawDeparture> LargestLawDeparture(const Study& study, std::span<const double> weights,
                                                const ModelFit& fit, std::size_t cause,
                                                double most_relative_size);

}  // namespace strainwave::analysis::diagnosis
