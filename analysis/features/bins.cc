// SPDX-License-Identifier: Apache-2.0
#include "analysis/features/bins.h"

// This file again for each kind of machine (docs/decisions/0018-vectors.md).
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "analysis/features/bins.cc"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace strainwave::analysis::features::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Tag = hn::ScalableTag<double>;
using Vector = hn::Vec<Tag>;
using CountTag = hn::RebindToSigned<Tag>;
using Counts = hn::Vec<CountTag>;
constexpr Tag kTag;
constexpr CountTag kCountTag;
constexpr std::size_t kLanes = hn::MaxLanes(kTag);
constexpr std::size_t kWidth = 4;  // vectors at a time, which hide how long one operation takes

HWY_ATTR void FindRange(const double* x, std::size_t n, double& least, double& greatest) {
  constexpr std::size_t kStep = kWidth * kLanes;
  double lows[kStep];
  double highs[kStep];
  std::size_t t = 0;
  Vector low[kWidth];
  Vector high[kWidth];
  for (std::size_t v = 0; v < kWidth; ++v) low[v] = high[v] = hn::Set(kTag, x[0]);
  for (; t + kStep <= n; t += kStep) {
    for (std::size_t v = 0; v < kWidth; ++v) {
      const Vector here = hn::LoadU(kTag, x + t + v * kLanes);
      low[v] = hn::Min(low[v], here);
      high[v] = hn::Max(high[v], here);
    }
  }
  for (std::size_t v = 0; v < kWidth; ++v) {
    hn::StoreU(low[v], kTag, lows + v * kLanes);
    hn::StoreU(high[v], kTag, highs + v * kLanes);
  }
  least = lows[0];
  greatest = highs[0];
  for (std::size_t i = 1; i < kStep; ++i) {
    least = lows[i] < least ? lows[i] : least;
    greatest = highs[i] > greatest ? highs[i] : greatest;
  }
  for (; t < n; ++t) {
    least = x[t] < least ? x[t] : least;
    greatest = x[t] > greatest ? x[t] : greatest;
  }
}

HWY_ATTR void FindEach(const double* x, std::size_t n, double low, double scale, std::uint32_t last,
                       std::uint32_t* out) {
  for (std::size_t i = 0; i < n; ++i) {
    const auto bucket = static_cast<std::uint32_t>(static_cast<std::int32_t>((x[i] - low) * scale));
    out[i] = bucket < last ? bucket : last;
  }
}

template <std::size_t Width>
HWY_INLINE void CountBelow(const double* x, const double* edges, std::size_t edge_count, std::int64_t* out) {
  Vector values[Width];
  Counts counts[Width];
  for (std::size_t v = 0; v < Width; ++v) {
    values[v] = hn::LoadU(kTag, x + v * kLanes);
    counts[v] = hn::Zero(kCountTag);
  }
  for (std::size_t e = 0; e < edge_count; ++e) {
    const Vector edge = hn::Set(kTag, edges[e]);
    // A mask is −1 as a whole number.
    for (std::size_t v = 0; v < Width; ++v) {
      const auto above = hn::VecFromMask(kTag, hn::Gt(values[v], edge));
      counts[v] = hn::Sub(counts[v], hn::BitCast(kCountTag, above));
    }
  }
  for (std::size_t v = 0; v < Width; ++v) hn::StoreU(counts[v], kCountTag, out + v * kLanes);
}

HWY_ATTR void CountEach(const double* x, std::size_t n, const double* edges, std::size_t edge_count,
                        std::int64_t* out) {
  std::size_t i = 0;
  for (; i + kWidth * kLanes <= n; i += kWidth * kLanes)
    CountBelow<kWidth>(x + i, edges, edge_count, out + i);
  for (; i < n; ++i) {
    out[i] = 0;
    for (std::size_t e = 0; e < edge_count; ++e) out[i] += x[i] > edges[e] ? 1 : 0;
  }
}

}  // namespace strainwave::analysis::features::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace strainwave::analysis::features {

HWY_EXPORT(FindRange);
HWY_EXPORT(FindEach);
HWY_EXPORT(CountEach);

Range RangeOf(std::span<const double> x) {
  Range range;
  HWY_DYNAMIC_DISPATCH(FindRange)(x.data(), x.size(), range.least, range.greatest);
  return range;
}

void FindBuckets(std::span<const double> x, double low, double scale, std::uint32_t last,
                 std::span<std::uint32_t> out) {
  HWY_DYNAMIC_DISPATCH(FindEach)(x.data(), x.size(), low, scale, last, out.data());
}

void CountEdgesBelow(std::span<const double> x, std::span<const double> edges, std::span<std::int64_t> out) {
  HWY_DYNAMIC_DISPATCH(CountEach)(x.data(), x.size(), edges.data(), edges.size(), out.data());
}

}  // namespace strainwave::analysis::features
#endif
