// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

/// The inner loops of the transform: short filters over blocks that stay in the first cache.
namespace strainwave::analysis::wavelets {

inline constexpr std::size_t kBlock = 256;    // coefficients at a time
inline constexpr std::size_t kMostHalf = 20;  // half the length of the longest filter
inline constexpr std::size_t kMostStep = 64;  // coefficients that filters compute at once
inline constexpr std::size_t kBlockRoom = kBlock + kMostHalf + kMostStep;

/// A segment of signal, its even and odd samples apart. Filters read a few values beyond what was filled in
/// and drop what comes of them.
struct PolyphaseBlock {
  double even[kBlockRoom]{};
  double odd[kBlockRoom]{};
};

struct CoefficientBlock {
  double values[kBlockRoom]{};
};

void Deinterleave(const double* signal, std::size_t pairs, double* even, double* odd);

/// out[m] = Σ_k taps[2k] even[m + k] + taps[2k + 1] odd[m + k], k < half, m < count.
void Filter(const PolyphaseBlock& block, const double* taps, std::size_t half, double* out,
            std::size_t count);

/// Two filters at once over the same samples.
void FilterBoth(const PolyphaseBlock& block, const double* low_taps, const double* high_taps,
                std::size_t half, double* low, double* high, std::size_t count);

/// The way back, for `kBlock` pairs of samples, with the decomposition filters:
/// even[m] = Σ_k low_taps[2k + 1] low[m + k] + high_taps[2k + 1] high[m + k], odd[m] with the taps 2k.
void Synthesize(const CoefficientBlock& low, const CoefficientBlock& high, const double* low_taps,
                const double* high_taps, std::size_t half, double* even, double* odd);

}  // namespace strainwave::analysis::wavelets
