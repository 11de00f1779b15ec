// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

namespace strainwave::analysis::reliability {

/// How well one feature foresees the end of life over several units, each number from 0 to 1, by the
/// definitions of docs/sources.md#coble-2009.
struct PrognosticWorth {
  double monotonicity{};    // mean over units of |rises − falls| / (n − 1)
  double prognosability{};  // exp(−σ(last values) / mean |first − last|)
  double trendability{};    // smallest |correlation| of two units over the share of life
  double sum() const { return monotonicity + prognosability + trendability; }
};

/// @param units  of each, the feature over its life in even steps, two values at least. Of one unit
/// prognosability is 1 and trendability is 1: they compare units.
/// Lives of different lengths are brought to the same 100 shares of life by lines between values. Noise makes
/// many falls of a rise: average before.
/// @throws std::invalid_argument for no unit, or one with fewer than two values.
PrognosticWorth WorthOf(std::span<const std::vector<double>> units);

}  // namespace strainwave::analysis::reliability
