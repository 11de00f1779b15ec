// SPDX-License-Identifier: Apache-2.0
#include "analysis/features/sorted_series.h"

#include <algorithm>
#include <limits>
#include <numeric>

#include "analysis/vector_clones.h"

namespace strainwave::analysis::features {
namespace {

constexpr std::size_t kFewValues = 256;
constexpr std::size_t kValuesPerBucket = 4;
constexpr std::uint32_t kMostBuckets = 1U << 16;

STRAINWAVE_VECTOR_CLONES
void FindBuckets(const double* x, std::size_t n, double low, double scale, std::uint32_t last,
                 std::uint32_t* out) {
  for (std::size_t i = 0; i < n; ++i) {
    const auto bucket = static_cast<std::int32_t>((x[i] - low) * scale);
    out[i] = std::min(static_cast<std::uint32_t>(bucket), last);
  }
}

}  // namespace

// Even buckets from the least to the greatest value, in rising order of their content; then each is sorted.
// Values far apart crowd into few buckets, which costs time and no more.
void SortedSeries::Sort(std::span<const double> x) {
  const auto [low, high] = std::ranges::minmax(x);
  const double span = high - low;
  const auto count =
      static_cast<std::uint32_t>(std::min<std::size_t>(x.size() / kValuesPerBucket + 1, kMostBuckets));
  const double scale = static_cast<double>(count) / span;
  if (x.size() < kFewValues || x.size() > std::numeric_limits<std::uint32_t>::max() ||
      !(scale <= std::numeric_limits<double>::max()) || !(span <= std::numeric_limits<double>::max())) {
    sorted_.assign(x.begin(), x.end());
    std::ranges::sort(sorted_);
    return;
  }
  sorted_.resize(x.size());
  buckets_.resize(x.size());
  FindBuckets(x.data(), x.size(), low, scale, count - 1, buckets_.data());
  ends_.assign(count + 1, 0);
  for (const std::uint32_t bucket : buckets_) ++ends_[bucket + 1];
  std::partial_sum(ends_.begin(), ends_.end(), ends_.begin());
  // ends_[b] is where bucket b begins, and moves to its end.
  for (std::size_t i = 0; i < x.size(); ++i) sorted_[ends_[buckets_[i]]++] = x[i];
  std::size_t begin = 0;
  for (std::uint32_t bucket = 0; bucket < count; ++bucket) {
    const std::size_t end = ends_[bucket];
    if (end - begin > 1) std::sort(sorted_.data() + begin, sorted_.data() + end);
    begin = end;
  }
}

}  // namespace strainwave::analysis::features
