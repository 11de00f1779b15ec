// SPDX-License-Identifier: Apache-2.0
#include "analysis/reliability/competing_modes.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <Eigen/LU>
#include <boost/math/tools/roots.hpp>

#include "analysis/reliability/weibull_likelihood.h"

namespace strainwave::analysis::reliability {
namespace {

using Eigen::Index, Eigen::VectorXd;

// Coordinates: ln t_p; the logits of the hazard's shares of all modes but the first; ln σ of all modes.
struct InSystemCoordinates {
  double hazard{};
  Index modes{};

  // ln η and ln σ of one.
  Eigen::Vector2d Mode(const VectorXd& at, Index k) const {
    double largest = 0.0;
    for (Index j = 1; j < modes; ++j) largest = std::max(largest, at(j));
    double total = std::exp(-largest);
    for (Index j = 1; j < modes; ++j) total += std::exp(at(j) - largest);
    const double log_share = (k == 0 ? 0.0 : at(k)) - largest - std::log(total);
    const double lambda = at(modes + k);
    return {at(0) - std::exp(lambda) * (std::log(hazard) + log_share), lambda};
  }

  // The laws kept, and their hazards at the new time scaled to the sum that they are to have.
  VectorXd Moved(const VectorXd& at, double log_time) const {
    VectorXd moved = at;
    moved(0) = log_time;
    const auto log_hazard = [&](Index k) {
      const Eigen::Vector2d mode = Mode(at, k);
      return (log_time - mode(0)) * std::exp(-mode(1));
    };
    for (Index k = 1; k < modes; ++k) moved(k) = log_hazard(k) - log_hazard(0);
    return moved;
  }

  VectorXd Of(const CompetingModes& fit, double quantile) const {
    VectorXd at(2 * modes);
    const auto hazard_of = [&](Index k) {
      const WeibullFit& mode = fit.modes[static_cast<std::size_t>(k)];
      return mode.shape * std::log(quantile / mode.scale);
    };
    at(0) = std::log(quantile);
    for (Index k = 0; k < modes; ++k) {
      if (k > 0) at(k) = hazard_of(k) - hazard_of(0);
      at(modes + k) = -std::log(fit.modes[static_cast<std::size_t>(k)].shape);
    }
    return at;
  }
};

const double kAtScale = -std::expm1(-1.0);

}  // namespace

std::vector<Lifetime> LivesOfMode(std::span<const ModeLifetime> lives, int mode) {
  std::vector<Lifetime> of_mode;
  for (const ModeLifetime& one : lives) {
    Lifetime life = one.life;
    if (life.is_failure() && one.mode != mode) life.upper = kNever;
    // One that failed before a time by another mode says nothing of this one.
    if (life.lower > 0.0 || life.is_failure()) of_mode.push_back(life);
  }
  return of_mode;
}

CompetingModes FitCompetingModes(std::span<const ModeLifetime> lives, int modes,
                                 const std::vector<std::string>& names) {
  CompetingModes fit;
  for (int mode = 0; mode < modes; ++mode) {
    try {
      fit.modes.push_back(FitWeibull(LivesOfMode(lives, mode)));
    } catch (const NoEstimate& error) {
      throw NoEstimate(fmt::format("mode {}: {}", names[static_cast<std::size_t>(mode)], error.what()),
                       error.expected());
    }
    fit.log_likelihood += fit.modes.back().log_likelihood;
  }
  return fit;
}

double SystemQuantile(const CompetingModes& fit, double share_failed) {
  const double hazard = -std::log1p(-share_failed);
  double earliest = kNever;
  for (const WeibullFit& mode : fit.modes)
    earliest = std::min(earliest, WeibullQuantile(mode.shape, mode.scale, share_failed));
  const auto miss = [&](double log_time) {
    double sum = 0.0;
    for (const WeibullFit& mode : fit.modes) sum += std::exp(mode.shape * (log_time - std::log(mode.scale)));
    return std::log(sum / hazard);
  };
  const double high = std::log(earliest);
  if (miss(high) <= 0.0) return earliest;
  double low = high - 1.0;
  while (miss(low) > 0.0) low -= 1.0;
  std::uintmax_t most = 200;
  const auto found =
      boost::math::tools::toms748_solve(miss, low, high, boost::math::tools::eps_tolerance<double>(50), most);
  return std::exp(0.5 * (found.first + found.second));
}

BoundedEstimate BoundsOfSystemQuantile(const CompetingModes& fit, std::span<const ModeLifetime> lives,
                                       double share_failed, double level) {
  const InSystemCoordinates coordinates{-std::log1p(-share_failed), static_cast<Index>(fit.modes.size())};
  std::vector<LogLikelihood> functions;
  for (int mode = 0; mode < static_cast<int>(fit.modes.size()); ++mode)
    functions.push_back(WeibullOfQuantile(LivesOfMode(lives, mode), kAtScale));
  const LogLikelihood function = ByDifferences([&](const VectorXd& at) {
    double sum = 0.0;
    for (std::size_t k = 0; k < functions.size(); ++k)
      sum += functions[k](coordinates.Mode(at, static_cast<Index>(k))).value;
    return sum;
  });
  const double quantile = SystemQuantile(fit, share_failed);
  Maximum maximum{coordinates.Of(fit, quantile), {}};
  maximum.evaluation = function(maximum.at);
  BoundedEstimate bounded;
  bounded.value = bounded.median_unbiased = quantile;
  const double variance = (-maximum.evaluation.hessian).inverse()(0, 0);
  const double half = NormalQuantile(0.5 * (1.0 + level)) * std::sqrt(variance);
  bounded.fisher = {quantile * std::exp(-half), quantile * std::exp(half)};
  const Interval log =
      LikelihoodRatioInterval(function, maximum, 0, level, {},
                              [&](const VectorXd& at, double psi) { return coordinates.Moved(at, psi); });
  bounded.likelihood_ratio = {std::exp(log.low), std::exp(log.high)};
  bounded.corrected = bounded.likelihood_ratio;
  return bounded;
}

}  // namespace strainwave::analysis::reliability
