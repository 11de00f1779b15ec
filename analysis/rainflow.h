// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

namespace strainwave::analysis {

/// A range of a load history, from one reversal to the next that closes it.
struct RainflowRange {
  double range{};   // > 0, unit of the load
  double mean{};    // middle of the range
  double cycles{};  // 1, or 0.5 for one that is not closed
};

/// What a part of a history closes, and its reversals that are still open, its last load among them: given
/// before what comes next, the count goes on as if the history had never been parted.
struct RainflowPart {
  std::vector<RainflowRange> closed;
  std::vector<double> open;
};

/// Rainflow count of a load history of any length: ranges in the order in which they are closed, then what
/// stays open as halves. Equal loads after one another count once; loads between two reversals do not count.
///
/// @param loads  in the order of time.
/// @throws std::invalid_argument if a load is not finite.
///
/// Source: ASTM E1049-85, section 5.4.4, with its worked example (docs/sources.md#astm-e1049).
std::vector<RainflowRange> CountRainflow(std::span<const double> loads);

/// The same of a part.
RainflowPart CountRainflowPart(std::span<const double> loads);

/// How many cycles of one range do as much as these: Σ n (rᵢ / r)^m, the sum of Miner over the cycles that r
/// alone would take, where life goes with the m-th power of the range.
/// @throws std::invalid_argument if `range` is not positive or the exponent not finite.
double EquivalentCycles(std::span<const RainflowRange> ranges, double range, double exponent);

}  // namespace strainwave::analysis
