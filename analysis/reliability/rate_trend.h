// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <random>

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <boost/random/normal_distribution.hpp>

#include "analysis/reliability/degradation_path.h"

namespace strainwave::analysis::reliability {

/// A unit at its last cycle; cycles count as multiples of it.
struct RateNow {
  double way{};       // to the limit, 1 at it
  double log_rate{};  // r, way per cycle
  double exponent{};  // β
};

/// The path of one unit, whatever its law. The rate r of degradation is above zero, and its logarithm is a
/// local linear trend over u = ln(cycle):
///   way = way₀ + ∫ r dcycle + noise,   d ln r = β du + σ dW₁,   dβ = μ du + τ dW₂,
/// of which a power of the cycles is the special case σ = τ = μ = 0. Its posterior is taken as normal about
/// its maximum (Laplace). Noise is what remains about the path, with its autocorrelation.
/// Source: docs/sources.md#harvey-1989, chapter 2.
class RateTrend {
 public:
  /// @throws std::invalid_argument for fewer than 8 points, or columns of different lengths.
  explicit RateTrend(const DegradationPath& path);

  double last_cycle() const { return last_cycle_; }
  /// Whether noise would not explain a straight line's slope towards the limit, at this level.
  bool IsApproached(double level) const;
  /// One draw of the posterior; only where the slope is above zero.
  RateNow Draw(boost::random::normal_distribution<double>& normal, std::mt19937_64& random) const;

 private:
  double last_cycle_{};
  double straight_slope_{};
  double slope_error_{};      // standard error, with the noise's autocorrelation
  Eigen::VectorXd cycle_;     // of the integral of the rate
  Eigen::MatrixXd log_rate_;  // what each parameter adds to ln r there
  Eigen::VectorXd mode_;
  Eigen::LLT<Eigen::MatrixXd> precision_;
};

/// What the random walks do in one step of the future, standard normal.
struct WanderStep {
  double exponent{};
  double rate{};
};
/// Steps of the future of which a wander is asked, at most: to ten thousand times the cycles seen.
inline constexpr std::size_t kFutureSteps = 120;

/// When the limit is met, as a multiple of the last cycle: 1 where it is met already, ∞ where it is not
/// within the future's steps. @param wander  asked once for each step, in order.
double CrossingOf(const RateNow& now, const std::function<WanderStep(std::size_t step)>& wander);

}  // namespace strainwave::analysis::reliability
