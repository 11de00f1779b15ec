// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "analysis/reliability/degradation_path.h"
#include "analysis/reliability/profile.h"
#include "analysis/reliability/rate_trend.h"

namespace strainwave::analysis::reliability {

/// When one unit comes to its limit.
struct LimitForecast {
  bool
      is_approached{};  // false: no trend towards the limit that noise would not explain; nothing else is set
  double cycle{};       // as likely before as after; ∞: rather never
  Interval interval;    // high ∞: the limit may never be met
};

/// From the path of this unit alone, whatever its law (rate_trend.h): the cycle at which the limit is first
/// met is simulated from the trend's posterior on.
/// @param level  of the two-sided interval, which never begins before the last cycle: the limit is not met
/// yet.
/// @throws std::invalid_argument for fewer than 8 points, or columns of different lengths.
LimitForecast ForecastLimit(const DegradationPath& path, double level);
LimitForecast ForecastLimit(const RateTrend& trend, double level);

}  // namespace strainwave::analysis::reliability
