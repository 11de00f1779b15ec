// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

/// Order statistics of a series.
namespace strainwave::analysis::features {

/// A series as if it were in rising order: its values stand in buckets that rise, of which only those are
/// sorted that are asked for. Its memory is used again by the next series.
class SortedSeries {
 public:
  /// @param x  finite values, at least one.
  void Assign(std::span<const double> x);
  std::size_t size() const { return values_.size(); }
  /// The k-th smallest, from 0 on; k < size().
  double At(std::size_t k);
  /// How many values are less than this finite one.
  std::size_t CountBelow(double value);

 private:
  std::span<const double> Bucket(std::size_t bucket);
  std::size_t BeginOf(std::size_t bucket) const { return bucket == 0 ? 0 : ends_[bucket - 1]; }

  double least_{};
  double greatest_{};
  double scale_{};  // buckets in a unit of value
  std::vector<double> values_;
  std::vector<std::uint32_t> places_;  // the bucket of each value, as it came
  std::vector<std::size_t> ends_;      // of each bucket in `values_`
  std::vector<bool> is_sorted_;
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
