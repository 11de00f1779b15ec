// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace strainwave::analysis {

struct AmplitudeSpectrum {
  std::vector<double> frequency_Hz;  // from 0 on, evenly spaced
  std::vector<double> amplitude;     // of a sine at that frequency, in the unit of the samples
};

/// Amplitudes over segments of `window` samples, each with its mean taken off and a Hann window, which overlap
/// by a half; the root of the mean of their squares. A sine between two frequencies appears at both, at least
/// 0.85 of its height.
/// @param window  a power of two; where there are fewer samples, the largest one that they fill.
/// @return empty for fewer than 8 samples.
/// Source: Welch, IEEE Trans. Audio Electroacoustics 15 (1967) 70.
AmplitudeSpectrum AmplitudeSpectrumOf(std::span<const double> values, double sample_rate_Hz,
                                      std::size_t window = 8192);

}  // namespace strainwave::analysis
