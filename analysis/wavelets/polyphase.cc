// SPDX-License-Identifier: Apache-2.0
#include "analysis/wavelets/polyphase.h"

#include <algorithm>
#include <cstring>

namespace strainwave::analysis::wavelets {
namespace {

// Several registers of sums hide the time that one addition takes. With more than a machine has, g++ 12 takes
// them through memory: `Vector` is what one register holds.
template <typename Vector>
constexpr std::size_t kStepOf = 4 * sizeof(Vector) / sizeof(double);

template <typename Vector>
[[gnu::always_inline]] inline void Store(const Vector* sums, double* out, std::size_t room) {
  std::memcpy(out, sums, std::min(room, kStepOf<Vector>) * sizeof(double));
}

template <typename Vector>
[[gnu::always_inline]] inline void FilterBy(const PolyphaseBlock& block, const double* taps, std::size_t half,
                                            double* out, std::size_t count) {
  for (std::size_t m = 0; m < count; m += kStepOf<Vector>) {
    Vector sums[4]{};
    for (std::size_t k = 0; k < half; ++k) {
      const auto* even = reinterpret_cast<const Vector*>(block.even + m + k);
      const auto* odd = reinterpret_cast<const Vector*>(block.odd + m + k);
      for (int v = 0; v < 4; ++v) sums[v] += taps[2 * k] * even[v];
      for (int v = 0; v < 4; ++v) sums[v] += taps[2 * k + 1] * odd[v];
    }
    Store(sums, out + m, count - m);
  }
}

template <typename Vector>
[[gnu::always_inline]] inline void FilterBothBy(const PolyphaseBlock& block, const double* low_taps,
                                                const double* high_taps, std::size_t half, double* low,
                                                double* high, std::size_t count) {
  for (std::size_t m = 0; m < count; m += kStepOf<Vector>) {
    Vector low_sums[4]{};
    Vector high_sums[4]{};
    for (std::size_t k = 0; k < half; ++k) {
      const auto* even = reinterpret_cast<const Vector*>(block.even + m + k);
      const auto* odd = reinterpret_cast<const Vector*>(block.odd + m + k);
      for (int v = 0; v < 4; ++v) {
        low_sums[v] += low_taps[2 * k] * even[v];
        high_sums[v] += high_taps[2 * k] * even[v];
      }
      for (int v = 0; v < 4; ++v) {
        low_sums[v] += low_taps[2 * k + 1] * odd[v];
        high_sums[v] += high_taps[2 * k + 1] * odd[v];
      }
    }
    Store(low_sums, low + m, count - m);
    Store(high_sums, high + m, count - m);
  }
}

template <typename Vector>
[[gnu::always_inline]] inline void SynthesizeBy(const CoefficientBlock& low, const CoefficientBlock& high,
                                                const double* low_taps, const double* high_taps,
                                                std::size_t half, double* even, double* odd) {
  for (std::size_t m = 0; m < kBlock; m += kStepOf<Vector>) {
    Vector even_sums[4]{};
    Vector odd_sums[4]{};
    for (std::size_t k = 0; k < half; ++k) {
      const auto* a = reinterpret_cast<const Vector*>(low.values + m + k);
      const auto* d = reinterpret_cast<const Vector*>(high.values + m + k);
      const std::size_t tap = 2 * k + 1;
      for (int v = 0; v < 4; ++v) {
        even_sums[v] += low_taps[tap] * a[v] + high_taps[tap] * d[v];
        odd_sums[v] += low_taps[tap - 1] * a[v] + high_taps[tap - 1] * d[v];
      }
    }
    Store(even_sums, even + m, kBlock - m);
    Store(odd_sums, odd + m, kBlock - m);
  }
}

STRAINWAVE_WIDE_VECTORS
void FilterWide(const PolyphaseBlock& block, const double* taps, std::size_t half, double* out,
                std::size_t count) {
  FilterBy<Lanes>(block, taps, half, out, count);
}

STRAINWAVE_HALF_VECTOR_CLONES
void FilterNarrow(const PolyphaseBlock& block, const double* taps, std::size_t half, double* out,
                  std::size_t count) {
  FilterBy<HalfLanes>(block, taps, half, out, count);
}

STRAINWAVE_WIDE_VECTORS
void FilterBothWide(const PolyphaseBlock& block, const double* low_taps, const double* high_taps,
                    std::size_t half, double* low, double* high, std::size_t count) {
  FilterBothBy<Lanes>(block, low_taps, high_taps, half, low, high, count);
}

STRAINWAVE_HALF_VECTOR_CLONES
void FilterBothNarrow(const PolyphaseBlock& block, const double* low_taps, const double* high_taps,
                      std::size_t half, double* low, double* high, std::size_t count) {
  FilterBothBy<HalfLanes>(block, low_taps, high_taps, half, low, high, count);
}

STRAINWAVE_WIDE_VECTORS
void SynthesizeWide(const CoefficientBlock& low, const CoefficientBlock& high, const double* low_taps,
                    const double* high_taps, std::size_t half, double* even, double* odd) {
  SynthesizeBy<Lanes>(low, high, low_taps, high_taps, half, even, odd);
}

STRAINWAVE_HALF_VECTOR_CLONES
void SynthesizeNarrow(const CoefficientBlock& low, const CoefficientBlock& high, const double* low_taps,
                      const double* high_taps, std::size_t half, double* even, double* odd) {
  SynthesizeBy<HalfLanes>(low, high, low_taps, high_taps, half, even, odd);
}

}  // namespace

STRAINWAVE_VECTOR_CLONES
void Deinterleave(const double* signal, std::size_t pairs, double* even, double* odd) {
  for (std::size_t i = 0; i < pairs; ++i) {
    even[i] = signal[2 * i];
    odd[i] = signal[2 * i + 1];
  }
}

void Filter(const PolyphaseBlock& block, const double* taps, std::size_t half, double* out,
            std::size_t count) {
  (HasWideVectors() ? FilterWide : FilterNarrow)(block, taps, half, out, count);
}

void FilterBoth(const PolyphaseBlock& block, const double* low_taps, const double* high_taps,
                std::size_t half, double* low, double* high, std::size_t count) {
  (HasWideVectors() ? FilterBothWide : FilterBothNarrow)(block, low_taps, high_taps, half, low, high, count);
}

void Synthesize(const CoefficientBlock& low, const CoefficientBlock& high, const double* low_taps,
                const double* high_taps, std::size_t half, double* even, double* odd) {
  (HasWideVectors() ? SynthesizeWide : SynthesizeNarrow)(low, high, low_taps, high_taps, half, even, odd);
}

}  // namespace strainwave::analysis::wavelets
