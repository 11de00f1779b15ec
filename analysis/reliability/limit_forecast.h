// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "analysis/reliability/degradation_path.h"
#include "analysis/reliability/profile.h"

namespace strainwave::analysis::reliability {

/// When one unit comes to its limit.
struct LimitForecast {
  bool
      is_approached{};  // false: no trend towards the limit that noise would not explain; nothing else is set
  double cycle{};       // as likely before as after; ∞: rather never
  Interval interval;    // high ∞: the limit may never be met
};

/// From the path of this unit alone, whatever its law. The rate r of degradation is above zero, and its
/// logarithm is a local linear trend over u = ln(cycle):
///   way = way₀ + ∫ r dcycle + noise,   d ln r = β du + σ dW₁,   dβ = μ du + τ dW₂,
/// of which a power of the cycles is the special case σ = τ = μ = 0. Its posterior is taken as normal about
/// its maximum (Laplace); the cycle at which the limit is first met is simulated from there on. Noise is
/// what remains about the path, with its autocorrelation. Source: docs/sources.md#harvey-1989, chapter 2.
/// @param level  of the two-sided interval, which never begins before the last cycle: the limit is not met
/// yet.
/// @throws std::invalid_argument for fewer than 8 points, or columns of different lengths.
LimitForecast ForecastLimit(const DegradationPath& path, double level);

}  // namespace strainwave::analysis::reliability
