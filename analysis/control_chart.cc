// SPDX-License-Identifier: Apache-2.0
#include "analysis/control_chart.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <vector>

#include "analysis/arguments.h"
#include "analysis/noise_level.h"

namespace strainwave::analysis {
namespace {

constexpr std::size_t kMinValues = 6;
// Median of |x₁ − x₂| of two standard normal values.
constexpr double kMedianRangePerSigma = 0.953873;
// Mean of the same, 2/√π, as tables have it: d₂ of two values.
constexpr double kMeanRangePerSigma = 1.128;
constexpr double kIndividualsWidth = 3.0;

}  // namespace

std::optional<ControlLimits> NextValueLimits(std::span<const double> history,
                                             const ControlChartOptions& options) {
  if (options.window < kMinValues) {
    throw std::invalid_argument(
        fmt::format("window = {} is too short (expected at least {})", options.window, kMinValues));
  }
  RequirePositive("width", options.width);
  RequireNotNegative("sigma_floor", options.sigma_floor);

  const std::size_t first = history.size() > options.window ? history.size() - options.window : 0;
  std::vector<double> x;
  std::vector<double> y;
  for (std::size_t i = first; i < history.size(); ++i) {
    if (std::isfinite(history[i])) {
      x.push_back(static_cast<double>(i) - static_cast<double>(history.size()));  // the next value is at 0
      y.push_back(history[i]);
    }
  }
  if (y.size() < kMinValues) {
    return std::nullopt;
  }
  std::vector<double> slopes;
  for (std::size_t i = 0; i < y.size(); ++i) {
    for (std::size_t j = i + 1; j < y.size(); ++j) {
      slopes.push_back((y[j] - y[i]) / (x[j] - x[i]));
    }
  }
  const double slope = Median(std::move(slopes));
  std::vector<double> offsets;
  std::vector<double> ranges;
  for (std::size_t i = 0; i < y.size(); ++i) {
    offsets.push_back(y[i] - slope * x[i]);
    if (i > 0) {
      ranges.push_back(std::abs(offsets[i] - offsets[i - 1]));
    }
  }
  ControlLimits limits;
  limits.sigma = std::max(Median(std::move(ranges)) / kMedianRangePerSigma, options.sigma_floor);
  limits.centre = Median(std::move(offsets));

  double mean_x = 0.0;
  for (double value : x) {
    mean_x += value / static_cast<double>(x.size());
  }
  double spread = 0.0;
  for (double value : x) {
    spread += (value - mean_x) * (value - mean_x);
  }
  const double factor = std::sqrt(1.0 + 1.0 / static_cast<double>(x.size()) + mean_x * mean_x / spread);
  limits.lower = limits.centre - options.width * factor * limits.sigma;
  limits.upper = limits.centre + options.width * factor * limits.sigma;
  return limits;
}

std::optional<ControlLimits> IndividualsLimits(std::span<const double> first) {
  double sum = 0.0;
  double ranges = 0.0;
  double count = 0.0;
  double before = 0.0;
  for (const double value : first) {
    if (!std::isfinite(value)) continue;
    if (count > 0.0) ranges += std::abs(value - before);
    sum += value;
    before = value;
    ++count;
  }
  if (count < 2.0) return std::nullopt;
  ControlLimits limits;
  limits.centre = sum / count;
  limits.sigma = ranges / (count - 1.0) / kMeanRangePerSigma;
  limits.lower = limits.centre - kIndividualsWidth * limits.sigma;
  limits.upper = limits.centre + kIndividualsWidth * limits.sigma;
  return limits;
}

}  // namespace strainwave::analysis
