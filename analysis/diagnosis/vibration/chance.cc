// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/vibration/chance.h"

#include <boost/math/special_functions/gamma.hpp>
#include <cmath>
#include <utility>

namespace strainwave::analysis::diagnosis {
namespace {

constexpr double kLargestRatio = 1000.0;  // beyond, p leaves the range of a double

}  // namespace

double ImprobabilityOf(double likelihood_ratio, double numbers) {
  const double half = 0.5 * numbers;
  const double x = 0.5 * likelihood_ratio;
  if (!(x > 0.0) || !(half > 0.0)) return 0.0;
  if (likelihood_ratio < kLargestRatio) return -std::log(boost::math::gamma_q(half, x));
  // The first term of the incomplete gamma function's series for large arguments.
  return x - (half - 1.0) * std::log(x) + std::lgamma(half);
}

double ImprobabilityOf(const VibrationResidual& residual, const TermFit& fit) {
  const double numbers = static_cast<double>(fit.free_parameters - residual.base().free_parameters);
  return ImprobabilityOf(residual.RatioOf(fit), numbers);
}

double LogChoices(std::size_t chosen, std::size_t of) {
  const auto k = static_cast<double>(chosen);
  const auto n = static_cast<double>(of);
  return std::lgamma(n + 1.0) - std::lgamma(k + 1.0) - std::lgamma(n - k + 1.0);
}

void LeastLikelyChance::Take(TermFit fit, double log_search_locations) {
  const double improbability = ImprobabilityOf(residual_, fit) - log_search_locations;
  if (best_ && improbability <= improbability_) return;
  improbability_ = improbability;
  best_ = std::move(fit);
}

void LeastLikelyChance::TakeWithAndWithoutUnobservable(TermFit fit, double log_search_locations) {
  Take(fit, log_search_locations);
  if (fit.channels.size() > 1) Take(residual_.WithoutUnobservable(std::move(fit)), log_search_locations);
}

}  // namespace strainwave::analysis::diagnosis
