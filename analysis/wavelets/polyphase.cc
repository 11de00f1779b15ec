// SPDX-License-Identifier: Apache-2.0
#include "analysis/wavelets/polyphase.h"

// This file again for each kind of machine (docs/decisions/0018-vectors.md).
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "analysis/wavelets/polyphase.cc"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace strainwave::analysis::wavelets::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Tag = hn::ScalableTag<double>;
using Vector = hn::Vec<Tag>;
constexpr Tag kTag;
constexpr std::size_t kLanes = hn::MaxLanes(kTag);
// So many sums hide the time that one addition takes, and stay in the sixteen registers of AVX2.
constexpr std::size_t kSums = 8;

HWY_ATTR void DeinterleavePairs(const double* signal, std::size_t pairs, double* even, double* odd) {
  std::size_t i = 0;
  for (; i + kLanes <= pairs; i += kLanes) {
    Vector evens;
    Vector odds;
    hn::LoadInterleaved2(kTag, signal + 2 * i, evens, odds);
    hn::StoreU(evens, kTag, even + i);
    hn::StoreU(odds, kTag, odd + i);
  }
  for (; i < pairs; ++i) {
    even[i] = signal[2 * i];
    odd[i] = signal[2 * i + 1];
  }
}

// Of filters over the same samples, `Width` vectors of sums each.
template <std::size_t Filters, std::size_t Width>
HWY_INLINE void FilterStep(const double* even, const double* odd, const double* const (&taps)[Filters],
                           std::size_t half, double* const (&out)[Filters]) {
  Vector sums[Filters][Width];
  for (auto& row : sums) {
    for (Vector& sum : row) sum = hn::Zero(kTag);
  }
  for (std::size_t k = 0; k < half; ++k) {
    for (std::size_t v = 0; v < Width; ++v) {
      const Vector values = hn::LoadU(kTag, even + k + v * kLanes);
      for (std::size_t f = 0; f < Filters; ++f)
        sums[f][v] = hn::Add(sums[f][v], hn::Mul(hn::Set(kTag, taps[f][2 * k]), values));
    }
    for (std::size_t v = 0; v < Width; ++v) {
      const Vector values = hn::LoadU(kTag, odd + k + v * kLanes);
      for (std::size_t f = 0; f < Filters; ++f)
        sums[f][v] = hn::Add(sums[f][v], hn::Mul(hn::Set(kTag, taps[f][2 * k + 1]), values));
    }
  }
  for (std::size_t f = 0; f < Filters; ++f) {
    for (std::size_t v = 0; v < Width; ++v) hn::StoreU(sums[f][v], kTag, out[f] + v * kLanes);
  }
}

template <std::size_t Filters>
HWY_INLINE void FilterAll(const PolyphaseBlock& block, const double* const (&taps)[Filters], std::size_t half,
                          double* const (&out)[Filters], std::size_t count) {
  constexpr std::size_t kWidth = kSums / Filters;
  double* here[Filters];
  std::size_t m = 0;
  for (; m + kWidth * kLanes <= count; m += kWidth * kLanes) {
    for (std::size_t f = 0; f < Filters; ++f) here[f] = out[f] + m;
    FilterStep<Filters, kWidth>(block.even + m, block.odd + m, taps, half, here);
  }
  for (; m + kLanes <= count; m += kLanes) {
    for (std::size_t f = 0; f < Filters; ++f) here[f] = out[f] + m;
    FilterStep<Filters, 1>(block.even + m, block.odd + m, taps, half, here);
  }
  if (m == count) return;
  double last[Filters][kLanes];
  for (std::size_t f = 0; f < Filters; ++f) here[f] = last[f];
  FilterStep<Filters, 1>(block.even + m, block.odd + m, taps, half, here);
  for (std::size_t f = 0; f < Filters; ++f) {
    for (std::size_t i = 0; m + i < count; ++i) out[f][m + i] = last[f][i];
  }
}

HWY_ATTR void FilterOne(const PolyphaseBlock& block, const double* taps, std::size_t half, double* out,
                        std::size_t count) {
  FilterAll<1>(block, {taps}, half, {out}, count);
}

HWY_ATTR void FilterTwo(const PolyphaseBlock& block, const double* low_taps, const double* high_taps,
                        std::size_t half, double* low, double* high, std::size_t count) {
  FilterAll<2>(block, {low_taps, high_taps}, half, {low, high}, count);
}

HWY_ATTR void SynthesizeBlock(const CoefficientBlock& low, const CoefficientBlock& high,
                              const double* low_taps, const double* high_taps, std::size_t half, double* even,
                              double* odd) {
  constexpr std::size_t kWidth = kSums / 2;
  static_assert(kBlock % (kWidth * kLanes) == 0);
  for (std::size_t m = 0; m < kBlock; m += kWidth * kLanes) {
    Vector even_sums[kWidth];
    Vector odd_sums[kWidth];
    for (std::size_t v = 0; v < kWidth; ++v) even_sums[v] = odd_sums[v] = hn::Zero(kTag);
    for (std::size_t k = 0; k < half; ++k) {
      for (std::size_t v = 0; v < kWidth; ++v) {
        const Vector a = hn::LoadU(kTag, low.values + m + k + v * kLanes);
        const Vector d = hn::LoadU(kTag, high.values + m + k + v * kLanes);
        even_sums[v] = hn::Add(even_sums[v], hn::Add(hn::Mul(hn::Set(kTag, low_taps[2 * k + 1]), a),
                                                     hn::Mul(hn::Set(kTag, high_taps[2 * k + 1]), d)));
        odd_sums[v] = hn::Add(odd_sums[v], hn::Add(hn::Mul(hn::Set(kTag, low_taps[2 * k]), a),
                                                   hn::Mul(hn::Set(kTag, high_taps[2 * k]), d)));
      }
    }
    for (std::size_t v = 0; v < kWidth; ++v) {
      hn::StoreU(even_sums[v], kTag, even + m + v * kLanes);
      hn::StoreU(odd_sums[v], kTag, odd + m + v * kLanes);
    }
  }
}

}  // namespace strainwave::analysis::wavelets::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace strainwave::analysis::wavelets {

HWY_EXPORT(DeinterleavePairs);
HWY_EXPORT(FilterOne);
HWY_EXPORT(FilterTwo);
HWY_EXPORT(SynthesizeBlock);

void Deinterleave(const double* signal, std::size_t pairs, double* even, double* odd) {
  HWY_DYNAMIC_DISPATCH(DeinterleavePairs)(signal, pairs, even, odd);
}

void Filter(const PolyphaseBlock& block, const double* taps, std::size_t half, double* out,
            std::size_t count) {
  HWY_DYNAMIC_DISPATCH(FilterOne)(block, taps, half, out, count);
}

void FilterBoth(const PolyphaseBlock& block, const double* low_taps, const double* high_taps,
                std::size_t half, double* low, double* high, std::size_t count) {
  HWY_DYNAMIC_DISPATCH(FilterTwo)(block, low_taps, high_taps, half, low, high, count);
}

void Synthesize(const CoefficientBlock& low, const CoefficientBlock& high, const double* low_taps,
                const double* high_taps, std::size_t half, double* even, double* odd) {
  HWY_DYNAMIC_DISPATCH(SynthesizeBlock)(low, high, low_taps, high_taps, half, even, odd);
}

}  // namespace strainwave::analysis::wavelets
#endif
