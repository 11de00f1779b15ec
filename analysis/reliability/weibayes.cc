// SPDX-License-Identifier: Apache-2.0
#include "analysis/reliability/weibayes.h"

#include <cmath>
#include <stdexcept>

#include <fmt/format.h>
#include <boost/math/special_functions/gamma.hpp>

#include "analysis/arguments.h"
#include "analysis/reliability/weibull_likelihood.h"

namespace strainwave::analysis::reliability {

Weibayes FitWeibayes(std::span<const Lifetime> lifetimes, double shape, double share_failed, double level) {
  RequireLifetimes(lifetimes);
  RequirePositive("shape", shape);
  double longest = 0.0;
  for (const Lifetime& life : lifetimes) longest = std::max(longest, life.lower);
  if (longest == 0.0) throw std::invalid_argument("lifetimes has no unit that is known to have run");
  double sum = 0.0;  // Σ (t / longest)^β
  for (const Lifetime& life : lifetimes) sum += life.count * std::pow(life.lower / longest, shape);
  const double failures = CountLifetimes(lifetimes).failures;
  const auto scale_of = [&](double hazards) { return longest * std::pow(sum / hazards, 1.0 / shape); };
  Weibayes fit;
  fit.shape = shape;
  // χ²(2 k) / 2 is a gamma variate of k.
  const double high = 0.5 * (1.0 + level);
  fit.scale_bounds = {scale_of(boost::math::gamma_p_inv(failures + 1.0, high)), kNever};
  const double to_quantile = std::exp(ExtremeValueQuantile(share_failed) / shape);
  if (failures > 0.0) {
    fit.scale = scale_of(failures);
    fit.scale_bounds.high = scale_of(boost::math::gamma_p_inv(failures, 1.0 - high));
    fit.quantile = *fit.scale * to_quantile;
  }
  fit.quantile_bounds = {fit.scale_bounds.low * to_quantile, fit.scale_bounds.high * to_quantile};
  return fit;
}

std::vector<Weibayes> WeibayesSensitivity(std::span<const Lifetime> lifetimes, double shape,
                                          double share_failed, double level) {
  std::vector<Weibayes> fits;
  for (const double factor : {0.5, 0.75, 1.0, 1.5, 2.0})
    fits.push_back(FitWeibayes(lifetimes, factor * shape, share_failed, level));
  return fits;
}

double ShapeOfQuantiles(double early_share, double early, double late_share, double late) {
  if (!(0.0 < early_share && early_share < late_share && late_share < 1.0))
    throw std::invalid_argument(
        fmt::format("shares {} and {} are not in order between 0 and 1", early_share, late_share));
  if (!(0.0 < early && early < late && std::isfinite(late)))
    throw std::invalid_argument(fmt::format("lives {} and {} are not in order above zero", early, late));
  return (ExtremeValueQuantile(late_share) - ExtremeValueQuantile(early_share)) / std::log(late / early);
}

}  // namespace strainwave::analysis::reliability
