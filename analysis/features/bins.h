// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>

/// Where values lie among others: loops over a series in vectors.
namespace strainwave::analysis::features {

struct Range {
  double least{};
  double greatest{};
};
/// Of at least one value, finite.
Range RangeOf(std::span<const double> x);

/// out[i] = the whole part of (x[i] − low) scale, at most `last`; low ≤ x[i], last < 2³¹.
void FindBuckets(std::span<const double> x, double low, double scale, std::uint32_t last,
                 std::span<std::uint32_t> out);

/// out[i] = how many of the edges lie below x[i].
void CountEdgesBelow(std::span<const double> x, std::span<const double> edges, std::span<std::int64_t> out);

}  // namespace strainwave::analysis::features
