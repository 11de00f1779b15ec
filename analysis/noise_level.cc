// SPDX-License-Identifier: Apache-2.0
#include "analysis/noise_level.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>

namespace strainwave::analysis {
namespace {

// Of a normal distribution: standard deviation over median of |x|.
constexpr double kDeviationPerMedian = 1.482602218505602;

}  // namespace

double Median(std::vector<double> values) {
  if (values.empty()) {
    return 0.0;
  }
  // A NaN has no place in any order; to look for one runs out of the values.
  if (std::ranges::any_of(values, [](double value) { return std::isnan(value); })) {
    return std::numeric_limits<double>::quiet_NaN();
  }
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  if (values.size() % 2 == 1) {
    return *middle;
  }
  return 0.5 * (*middle + *std::max_element(values.begin(), middle));
}

double RobustStandardDeviation(std::span<const double> centred) {
  std::vector<double> magnitude(centred.size());
  std::transform(centred.begin(), centred.end(), magnitude.begin(), [](double x) { return std::abs(x); });
  return kDeviationPerMedian * Median(std::move(magnitude));
}

NoiseLevel EstimateNoise(std::span<const double> signal) {
  NoiseLevel noise;
  if (signal.size() < 3) {
    return noise;
  }
  std::vector<double> second_differences;
  second_differences.reserve(signal.size() - 2);
  for (std::size_t i = 1; i + 1 < signal.size(); ++i) {
    second_differences.push_back(signal[i + 1] - 2.0 * signal[i] + signal[i - 1]);
  }
  // Variance of a second difference of white noise: (1 + 4 + 1) σ².
  noise.standard_deviation = RobustStandardDeviation(second_differences) / std::sqrt(6.0);
  for (std::size_t i = 1; i < signal.size(); ++i) {
    const double difference = std::abs(signal[i] - signal[i - 1]);
    if (difference > 0.0 && (noise.step == 0.0 || difference < noise.step)) {
      noise.step = difference;
    }
  }
  return noise;
}

double ReversalThreshold(const NoiseLevel& noise) {
  return std::max(10.0 * noise.standard_deviation, 1.5 * noise.step);
}

std::vector<std::size_t> FindSpikes(std::span<const double> signal, const NoiseLevel& noise) {
  std::vector<std::size_t> spikes;
  if (signal.size() < 5) {
    return spikes;
  }
  std::vector<double> steps(signal.size() - 1);
  for (std::size_t i = 0; i + 1 < signal.size(); ++i) {
    steps[i] = std::abs(signal[i + 1] - signal[i]);
  }
  const double allowed = 8.0 * noise.standard_deviation + 4.0 * Median(std::move(steps)) + 2.0 * noise.step;
  if (std::isnan(allowed)) {
    return spikes;
  }
  for (std::size_t i = 0; i < signal.size(); ++i) {
    const std::size_t first = std::min(i < 2 ? 0 : i - 2, signal.size() - 5);
    std::array<double, 5> window{};
    std::copy_n(signal.begin() + static_cast<std::ptrdiff_t>(first), 5, window.begin());
    std::nth_element(window.begin(), window.begin() + 2, window.end());
    if (std::abs(signal[i] - window[2]) > allowed) {
      spikes.push_back(i);
    }
  }
  return spikes;
}

void InterpolateOver(std::span<double> signal, std::span<const std::size_t> indices) {
  for (std::size_t k = 0; k < indices.size();) {
    std::size_t last = k;
    while (last + 1 < indices.size() && indices[last + 1] == indices[last] + 1) {
      ++last;
    }
    const std::size_t first_bad = indices[k];
    const std::size_t last_bad = indices[last];
    const bool has_left = first_bad > 0;
    const bool has_right = last_bad + 1 < signal.size();
    for (std::size_t i = first_bad; i <= last_bad; ++i) {
      if (has_left && has_right) {
        const double share =
            static_cast<double>(i - first_bad + 1) / static_cast<double>(last_bad - first_bad + 2);
        signal[i] = signal[first_bad - 1] + share * (signal[last_bad + 1] - signal[first_bad - 1]);
      } else if (has_left) {
        signal[i] = signal[first_bad - 1];
      } else if (has_right) {
        signal[i] = signal[last_bad + 1];
      }
    }
    k = last + 1;
  }
}

}  // namespace strainwave::analysis
