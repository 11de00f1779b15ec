// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <limits>
#include <optional>
#include <span>
#include <vector>

namespace strainwave::analysis::samples {

/// A channel that is written again and again until its next value comes.
struct Held {
  std::size_t runs{};       // values that were written more than once
  std::size_t repeated{};   // rows that are no new value
  std::size_t longest{};    // rows that one value stands
  std::vector<bool> fresh;  // one a row
};

/// Finds values that stand for several rows while the signal goes on by several of its steps from one to the
/// next, many times in the record and more often than its resolution makes values equal: neither a rest nor
/// the steps of an encoder do that. A signal of few levels is a command in steps, and none.
/// @param coarsest_step  of a sensor of this kind: even changes that are larger are no steps.
std::optional<Held> FindHeld(std::span<const double> values,
                             double coarsest_step = std::numeric_limits<double>::infinity());

/// Median change of another signal over the rows where this one stands, as a share of that over the rows
/// where it changes: near 1 where that one knows nothing of the steps, near 0 where it rests with them.
double GoesOnMeanwhile(const Held& held, std::span<const double> other);

/// Rows, from 0, of one value where the signal's own noise would never let it stand.
struct Frozen {
  std::size_t first{};
  std::size_t count{};
};

/// Finds segments of one value, to the last digit, in a signal whose noise is several of its steps. In a
/// signal without visible noise, and at the ends of the signal's range, where it may be clipped, those of 8
/// values and more that were left, or come to, by a jump three times as large as any other change.
std::vector<Frozen> FindFrozen(std::span<const double> values);

/// An end of a signal's range at which it stands where its own noise would never let it: the range of its
/// sensor or amplifier ends there.
struct Saturated {
  double at{};
  std::size_t count{};  // rows
};

/// The smallest value, the largest, both or none. A signal without visible noise tells nothing, and one that
/// stands as long elsewhere is held.
std::vector<Saturated> FindSaturated(std::span<const double> values);

/// Segments of one value, of so many rows and more.
std::vector<Frozen> StandingSegments(std::span<const double> values, std::size_t fewest);

}  // namespace strainwave::analysis::samples
