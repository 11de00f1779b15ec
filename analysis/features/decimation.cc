// SPDX-License-Identifier: Apache-2.0
#include "analysis/features/decimation.h"

#include <fmt/format.h>

#include <cmath>
#include <cstddef>
#include <numbers>
#include <stdexcept>

namespace strainwave::analysis::features {
namespace {

constexpr int kSideSamples = 16;  // of the new rate
constexpr double kCutOff = 0.95;  // of the new Nyquist frequency, where half the amplitude is left

// One side of the filter, from its middle; the whole of it sums to 1.
std::vector<double> HalfFilter(int factor) {
  const int side = kSideSamples * factor;
  std::vector<double> filter(static_cast<std::size_t>(side) + 1);
  double sum = 0.0;
  for (int i = 0; i <= side; ++i) {
    const double x = std::numbers::pi * kCutOff * i / factor;
    const double sinc = i == 0 ? 1.0 : std::sin(x) / x;
    filter[static_cast<std::size_t>(i)] = sinc * (0.5 + 0.5 * std::cos(std::numbers::pi * i / (side + 1)));
    sum += (i == 0 ? 1.0 : 2.0) * filter[static_cast<std::size_t>(i)];
  }
  for (double& value : filter) value /= sum;
  return filter;
}

}  // namespace

std::vector<double> Decimate(std::span<const double> signal, int factor) {
  if (factor < 1) throw std::invalid_argument(fmt::format("factor = {} is not from 1 up", factor));
  if (signal.empty()) throw std::invalid_argument("signal has no samples (expected at least one)");
  if (factor == 1) return {signal.begin(), signal.end()};
  const std::vector<double> filter = HalfFilter(factor);
  const auto count = static_cast<std::ptrdiff_t>(signal.size());
  const std::ptrdiff_t period = count > 1 ? 2 * (count - 1) : 1;
  const auto mirrored = [&](std::ptrdiff_t i) {
    i = ((i % period) + period) % period;
    return signal[static_cast<std::size_t>(i < count ? i : period - i)];
  };
  std::vector<double> result;
  result.reserve(signal.size() / static_cast<std::size_t>(factor) + 1);
  for (std::ptrdiff_t middle = 0; middle < count; middle += factor) {
    double sum = filter[0] * signal[static_cast<std::size_t>(middle)];
    for (std::size_t k = 1; k < filter.size(); ++k) {
      const auto off = static_cast<std::ptrdiff_t>(k);
      sum += filter[k] * (mirrored(middle - off) + mirrored(middle + off));
    }
    result.push_back(sum);
  }
  return result;
}

}  // namespace strainwave::analysis::features
