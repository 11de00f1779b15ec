// SPDX-License-Identifier: Apache-2.0
#include "analysis/reliability/limit_forecast.h"

#include <algorithm>
#include <random>

#include <boost/random/normal_distribution.hpp>

namespace strainwave::analysis::reliability {

LimitForecast ForecastLimit(const DegradationPath& path, double level) {
  return ForecastLimit(RateTrend(path), level);
}

LimitForecast ForecastLimit(const RateTrend& trend, double level) {
  constexpr int kDraws = 2000;
  LimitForecast forecast;
  if (!trend.IsApproached(level)) return forecast;
  std::mt19937_64 random(1);
  boost::random::normal_distribution<double> normal;
  const auto wander = [&](std::size_t) {
    const double exponent = normal(random);
    return WanderStep{exponent, normal(random)};
  };
  std::vector<double> crossings;
  for (int draw = 0; draw < kDraws; ++draw)
    crossings.push_back(CrossingOf(trend.Draw(normal, random), wander));
  std::ranges::sort(crossings);
  const auto quantile = [&](double share) {
    return trend.last_cycle() *
           crossings[static_cast<std::size_t>(share * static_cast<double>(crossings.size() - 1))];
  };
  forecast.cycle = quantile(0.5);
  forecast.interval = {quantile(0.5 * (1.0 - level)), quantile(0.5 * (1.0 + level))};
  forecast.is_approached = true;
  return forecast;
}

}  // namespace strainwave::analysis::reliability
