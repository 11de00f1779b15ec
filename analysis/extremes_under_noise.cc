// SPDX-License-Identifier: Apache-2.0
#include "analysis/extremes_under_noise.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "analysis/arguments.h"

namespace strainwave::analysis {
namespace {

struct Moments {
  double mean{};
  double variance{};
};

// Depths (max f − fᵢ) / σ of the values that can come out on top, thinned: each stands for `weight`
// neighbours in order.
struct Contenders {
  std::vector<double> depths;
  double weight{1.0};
};

Contenders FindContenders(std::span<const double> curve, double sign, double standard_deviation) {
  constexpr double kNeverWins = 12.0;
  constexpr std::size_t kMostDepths = 500;
  double top = sign * curve.front();
  for (double value : curve) {
    top = std::max(top, sign * value);
  }
  std::vector<double> depths;
  for (double value : curve) {
    const double depth = (top - sign * value) / standard_deviation;
    if (depth < kNeverWins) {
      depths.push_back(depth);
    }
  }
  std::sort(depths.begin(), depths.end());
  const std::size_t every = (depths.size() + kMostDepths - 1) / kMostDepths;
  Contenders contenders;
  for (std::size_t i = every / 2; i < depths.size(); i += every) {
    contenders.depths.push_back(depths[i]);
  }
  contenders.weight = static_cast<double>(depths.size()) / static_cast<double>(contenders.depths.size());
  return contenders;
}

// Of max(fᵢ + εᵢ) − max(fᵢ), in units of σ.
Moments MaximumAboveTop(const Contenders& contenders) {
  constexpr double kStep = 0.02;
  constexpr int kSteps = 400;  // to ±8 standard deviations
  // E[X] = ∫ (1 − F) over x > 0 − ∫ F over x < 0, and E[X²] likewise with 2|x|; midpoint rule.
  double mean = 0.0;
  double square = 0.0;
  for (int k = -kSteps; k < kSteps; ++k) {
    const double x = (k + 0.5) * kStep;
    double log_distribution = 0.0;
    for (double depth : contenders.depths) {
      log_distribution += std::log(std::max(0.5 * std::erfc(-(x + depth) / std::sqrt(2.0)), 1e-300));
    }
    const double distribution = std::exp(contenders.weight * log_distribution);
    const double tail = x > 0.0 ? 1.0 - distribution : -distribution;
    mean += tail * kStep;
    square += 2.0 * x * tail * kStep;
  }
  return {mean, std::max(0.0, square - mean * mean)};
}

}  // namespace

RangeUnderNoise ExpectRangeUnderNoise(std::span<const double> curve, double standard_deviation) {
  RequireAtLeast("curve", curve, 1);
  RequireNotNegative("standard_deviation", standard_deviation);
  if (standard_deviation == 0.0) {
    return {};
  }
  const Moments top = MaximumAboveTop(FindContenders(curve, 1.0, standard_deviation));
  const Moments bottom = MaximumAboveTop(FindContenders(curve, -1.0, standard_deviation));
  const double bias = top.mean + bottom.mean;
  return {standard_deviation * bias,
          standard_deviation * std::sqrt(bias * bias + top.variance + bottom.variance)};
}

}  // namespace strainwave::analysis
