// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

/// Order statistics of a series.
namespace strainwave::analysis::features {

/// The values in rising order; its memory is used again by the next series.
class SortedSeries {
 public:
  /// @param x  finite values, at least one.
  void Sort(std::span<const double> x);
  std::span<const double> values() const { return sorted_; }

 private:
  std::vector<double> sorted_;
  std::vector<std::uint32_t> buckets_;  // of each value
  std::vector<std::uint32_t> ends_;
};

/// The q-quantile, 0 ≤ q ≤ 1, of n values: on the straight line between the two that stand about place
/// q (n − 1), in NumPy's arithmetic ('linear'). `at(k)` is the k-th smallest.
template <typename ValueAt>
double Quantile(std::size_t n, double q, const ValueAt& at) {
  const double place = static_cast<double>(n - 1) * q;
  const auto below = static_cast<std::size_t>(place);
  if (below + 1 >= n) return at(n - 1);
  const double share = place - static_cast<double>(below);
  const double low = at(below);
  const double high = at(below + 1);
  return share >= 0.5 ? high - (high - low) * (1.0 - share) : low + (high - low) * share;
}

}  // namespace strainwave::analysis::features
