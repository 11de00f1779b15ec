// SPDX-License-Identifier: Apache-2.0
#include "analysis/amplitude_spectrum.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <complex>
#include <numbers>
#include <numeric>

#include <Eigen/Core>
#include <unsupported/Eigen/FFT>

namespace strainwave::analysis {

AmplitudeSpectrum AmplitudeSpectrumOf(std::span<const double> values, double sample_rate_Hz,
                                      std::size_t window) {
  constexpr std::size_t kFewest = 8;
  if (values.size() < kFewest) return {};
  const std::size_t length = std::min(window, std::bit_floor(values.size()));
  std::vector<double> hann(length);
  for (std::size_t i = 0; i < length; ++i) {
    hann[i] =
        0.5 - 0.5 * std::cos(2.0 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(length));
  }
  const double sum = std::accumulate(hann.begin(), hann.end(), 0.0);
  Eigen::FFT<double> fft;
  fft.SetFlag(Eigen::FFT<double>::HalfSpectrum);
  std::vector<double> segment(length);
  std::vector<std::complex<double>> transformed;
  std::vector<double> squares(length / 2 + 1);
  std::size_t segments = 0;
  for (std::size_t first = 0; first + length <= values.size(); first += length / 2, ++segments) {
    const auto part = values.subspan(first, length);
    const double mean = std::accumulate(part.begin(), part.end(), 0.0) / static_cast<double>(length);
    for (std::size_t i = 0; i < length; ++i) segment[i] = hann[i] * (part[i] - mean);
    fft.fwd(transformed, segment);
    for (std::size_t k = 0; k < squares.size(); ++k) squares[k] += std::norm(transformed[k]);
  }
  AmplitudeSpectrum spectrum;
  for (std::size_t k = 0; k < squares.size(); ++k) {
    spectrum.frequency_Hz.push_back(sample_rate_Hz * static_cast<double>(k) / static_cast<double>(length));
    spectrum.amplitude.push_back(2.0 / sum * std::sqrt(squares[k] / static_cast<double>(segments)));
  }
  return spectrum;
}

}  // namespace strainwave::analysis
