// SPDX-License-Identifier: Apache-2.0
#include "analysis/features/sorted_series.h"

#include <algorithm>
#include <limits>

#include "analysis/features/bins.h"

namespace strainwave::analysis::features {
namespace {

constexpr std::size_t kFewValues = 256;
constexpr std::size_t kValuesPerBucket = 4;
constexpr std::size_t kMostBuckets = 1U << 16;

}  // namespace

// Even buckets from the least to the greatest value. Values far apart crowd into few of them, which costs
// time and no more.
void SortedSeries::Assign(std::span<const double> x) {
  const Range range = RangeOf(x);
  least_ = range.least;
  greatest_ = range.greatest;
  const double span = greatest_ - least_;
  std::size_t count = std::min(x.size() / kValuesPerBucket + 1, kMostBuckets);
  scale_ = static_cast<double>(count) / span;
  if (x.size() < kFewValues || !(scale_ <= std::numeric_limits<double>::max()) ||
      !(span <= std::numeric_limits<double>::max()))
    count = 1;
  is_sorted_.assign(count, false);
  if (count == 1) {
    values_.assign(x.begin(), x.end());
    ends_ = {x.size()};
    return;
  }
  values_.resize(x.size());
  places_.resize(x.size());
  FindBuckets(x, least_, scale_, static_cast<std::uint32_t>(count - 1), places_);
  ends_.assign(count + 1, 0);
  for (const std::uint32_t bucket : places_) ++ends_[bucket + 1];
  for (std::size_t bucket = 1; bucket <= count; ++bucket) ends_[bucket] += ends_[bucket - 1];
  // ends_[b] is where bucket b begins, and moves to its end.
  for (std::size_t i = 0; i < x.size(); ++i) values_[ends_[places_[i]]++] = x[i];
  ends_.pop_back();
}

std::span<const double> SortedSeries::Bucket(std::size_t bucket) {
  const std::size_t begin = BeginOf(bucket);
  const std::span<double> values(values_.data() + begin, ends_[bucket] - begin);
  if (!is_sorted_[bucket]) std::ranges::sort(values);
  is_sorted_[bucket] = true;
  return values;
}

double SortedSeries::At(std::size_t k) {
  const auto bucket = static_cast<std::size_t>(std::ranges::upper_bound(ends_, k) - ends_.begin());
  return Bucket(bucket)[k - BeginOf(bucket)];
}

std::size_t SortedSeries::CountBelow(double value) {
  if (value <= least_) return 0;
  if (value > greatest_) return size();
  const std::size_t last = ends_.size() - 1;
  const std::size_t bucket =
      last == 0 ? 0 : std::min(static_cast<std::size_t>((value - least_) * scale_), last);
  const std::span<const double> values = Bucket(bucket);
  return BeginOf(bucket) + static_cast<std::size_t>(std::ranges::lower_bound(values, value) - values.begin());
}

}  // namespace strainwave::analysis::features
