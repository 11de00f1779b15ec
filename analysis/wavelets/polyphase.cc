// SPDX-License-Identifier: Apache-2.0
#include "analysis/wavelets/polyphase.h"

#include <algorithm>
#include <cstring>

namespace strainwave::analysis::wavelets {
namespace {

// Several registers of sums hide the time that one addition takes.
constexpr std::size_t kStep = 4 * kLanes;

void Store(const double* sums, double* out, std::size_t room) {
  std::memcpy(out, sums, std::min(room, kStep) * sizeof(double));
}

}  // namespace

STRAINWAVE_VECTOR_CLONES
void Deinterleave(const double* signal, std::size_t pairs, double* even, double* odd) {
  for (std::size_t i = 0; i < pairs; ++i) {
    even[i] = signal[2 * i];
    odd[i] = signal[2 * i + 1];
  }
}

STRAINWAVE_VECTOR_CLONES
void Filter(const PolyphaseBlock& block, const double* taps, std::size_t half, double* out,
            std::size_t count) {
  for (std::size_t m = 0; m < count; m += kStep) {
    Lanes sums[4]{};
    for (std::size_t k = 0; k < half; ++k) {
      const auto* even = reinterpret_cast<const Lanes*>(block.even + m + k);
      const auto* odd = reinterpret_cast<const Lanes*>(block.odd + m + k);
      for (int v = 0; v < 4; ++v) sums[v] += taps[2 * k] * even[v];
      for (int v = 0; v < 4; ++v) sums[v] += taps[2 * k + 1] * odd[v];
    }
    Store(reinterpret_cast<const double*>(sums), out + m, count - m);
  }
}

STRAINWAVE_VECTOR_CLONES
void FilterBoth(const PolyphaseBlock& block, const double* low_taps, const double* high_taps,
                std::size_t half, double* low, double* high, std::size_t count) {
  for (std::size_t m = 0; m < count; m += kStep) {
    Lanes low_sums[4]{};
    Lanes high_sums[4]{};
    for (std::size_t k = 0; k < half; ++k) {
      const auto* even = reinterpret_cast<const Lanes*>(block.even + m + k);
      const auto* odd = reinterpret_cast<const Lanes*>(block.odd + m + k);
      for (int v = 0; v < 4; ++v) {
        low_sums[v] += low_taps[2 * k] * even[v];
        high_sums[v] += high_taps[2 * k] * even[v];
      }
      for (int v = 0; v < 4; ++v) {
        low_sums[v] += low_taps[2 * k + 1] * odd[v];
        high_sums[v] += high_taps[2 * k + 1] * odd[v];
      }
    }
    Store(reinterpret_cast<const double*>(low_sums), low + m, count - m);
    Store(reinterpret_cast<const double*>(high_sums), high + m, count - m);
  }
}

STRAINWAVE_VECTOR_CLONES
void Synthesize(const CoefficientBlock& low, const CoefficientBlock& high, const double* low_taps,
                const double* high_taps, std::size_t half, double* even, double* odd) {
  for (std::size_t m = 0; m < kBlock; m += kStep) {
    Lanes even_sums[4]{};
    Lanes odd_sums[4]{};
    for (std::size_t k = 0; k < half; ++k) {
      const auto* a = reinterpret_cast<const Lanes*>(low.values + m + k);
      const auto* d = reinterpret_cast<const Lanes*>(high.values + m + k);
      const std::size_t tap = 2 * k + 1;
      for (int v = 0; v < 4; ++v) {
        even_sums[v] += low_taps[tap] * a[v] + high_taps[tap] * d[v];
        odd_sums[v] += low_taps[tap - 1] * a[v] + high_taps[tap - 1] * d[v];
      }
    }
    Store(reinterpret_cast<const double*>(even_sums), even + m, kStep);
    Store(reinterpret_cast<const double*>(odd_sums), odd + m, kStep);
  }
}

}  // namespace strainwave::analysis::wavelets
