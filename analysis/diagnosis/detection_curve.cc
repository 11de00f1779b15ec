// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/detection_curve.h"

#include <algorithm>
#include <array>
#include <boost/math/special_functions/erf.hpp>
#include <cmath>
#include <limits>
#include <numbers>

namespace strainwave::analysis::diagnosis {
namespace {

constexpr std::array kWidths{0.1, 0.2, 0.35, 0.6, 1.0};  // of ln size: the grid, from sharper than any search
constexpr std::array kLapses{0.0, 0.02, 0.05};
constexpr double kStep = 0.05;                   // of ln size: a twentieth of the size
const double kBeyond = 3.0 * std::numbers::ln2;  // of ln size, to either side of what was tried
constexpr double kExpectedScale = 0.7;           // of ln size: twice or half as much is nothing unusual
constexpr double kExpectedFloor = 0.01;
constexpr double kLeastProbability = 1e-9;

double NormalShare(double z) { return 0.5 * std::erfc(-z / std::numbers::sqrt2); }
double NormalQuantile(double p) { return std::numbers::sqrt2 * boost::math::erf_inv(2.0 * p - 1.0); }

// x90 on an even grid with its probability, not normalised.
struct Posterior {
  double first{};
  std::vector<double> weight;

  double At(double index) const { return first + kStep * index; }
  // Linear within a step.
  double Quantile(double share) const {
    double sum = 0.0;
    for (const double w : weight) sum += w;
    double before = 0.0;
    for (std::size_t k = 0; k < weight.size(); ++k) {
      if (before + weight[k] >= share * sum && weight[k] > 0.0)
        return At(static_cast<double>(k) - 0.5 + (share * sum - before) / weight[k]);
      before += weight[k];
    }
    return At(static_cast<double>(weight.size()) - 0.5);
  }
};

// Probability of the trials for each x90 from `low` to `high`, averaged over widths and lapses.
Posterior PosteriorOf(std::span<const PlantedTrial> trials, double low, double high) {
  const auto steps = static_cast<std::size_t>(std::ceil((high - low) / kStep)) + 1;
  struct Shape {
    double width{}, lapse{}, at_x90{};
  };
  std::vector<Shape> shapes;
  for (const double width : kWidths) {
    for (const double lapse : kLapses)
      shapes.push_back({width, lapse, NormalQuantile(kDetectionProbability / (1.0 - lapse))});
  }
  std::vector<double> logarithms(steps * shapes.size(), 0.0);
  double largest = -std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < steps; ++k) {
    for (std::size_t s = 0; s < shapes.size(); ++s) {
      double& sum = logarithms[k * shapes.size() + s];
      for (const PlantedTrial& trial : trials) {
        const double off = trial.ln_size - (low + kStep * static_cast<double>(k));
        const double p = (1.0 - shapes[s].lapse) * NormalShare(off / shapes[s].width + shapes[s].at_x90);
        sum += std::log(std::max(trial.found ? p : 1.0 - p, kLeastProbability));
      }
      largest = std::max(largest, sum);
    }
  }
  Posterior posterior{low, std::vector<double>(steps, 0.0)};
  for (std::size_t i = 0; i < logarithms.size(); ++i)
    posterior.weight[i / shapes.size()] += std::exp(logarithms[i] - largest);
  return posterior;
}

}  // namespace

DetectableSize EstimateDetectableSize(std::span<const PlantedTrial> trials) {
  const auto [least, most] = std::ranges::minmax(trials, {}, &PlantedTrial::ln_size);
  const Posterior posterior = PosteriorOf(trials, least.ln_size - kBeyond, most.ln_size + kBeyond);
  DetectableSize size{posterior.Quantile(0.5), posterior.Quantile(0.025), posterior.Quantile(0.975), true};
  size.reached = size.ln_size <= most.ln_size;
  if (size.ln_high > most.ln_size + 0.5 * kBeyond) size.ln_high = std::numeric_limits<double>::infinity();
  return size;
}

std::vector<double> NextLnSizes(std::span<const PlantedTrial> trials, double ln_expected, double ln_most,
                                std::size_t count) {
  Posterior posterior = PosteriorOf(trials, ln_expected - 2.0 * kBeyond, ln_expected + 2.0 * kBeyond);
  for (std::size_t k = 0; k < posterior.weight.size(); ++k) {
    const double off = std::abs(posterior.At(static_cast<double>(k)) - ln_expected);
    posterior.weight[k] *= std::exp(-off / kExpectedScale) + kExpectedFloor;
  }
  std::vector<double> sizes;
  for (std::size_t k = 0; k < count; ++k) {
    const double share = (static_cast<double>(k) + 0.5) / static_cast<double>(count);
    sizes.push_back(std::min(ln_most, posterior.Quantile(share)));
  }
  return sizes;
}

}  // namespace strainwave::analysis::diagnosis
