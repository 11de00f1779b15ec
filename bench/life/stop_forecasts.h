// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "analysis/reliability/limit_forecast.h"
#include "bench/campaign/journal.h"

namespace strainwave::bench {

/// As few complete cycles make a trend.
inline constexpr std::size_t kFewestCyclesOfTrend = 8;
/// The mean of as many is the value at first.
inline constexpr std::size_t kCyclesAtFirst = 5;

/// Finite values without a flag of one quantity in complete cycles, oldest first; measured again, the last
/// one.
struct ResultSeries {
  std::vector<double> cycle;
  std::vector<double> value;

  double AtFirst() const;
};
std::map<std::string, ResultSeries> ResultSeriesOf(const Journal& journal);

/// A quantity on its way from its first values to a limit.
struct CampaignLimit {
  std::string quantity;
  double first{};  // mean of the first cycles
  double last{};   // of the last
  double limit{};
  std::optional<int> met_at;  // cycle
  analysis::reliability::DegradationPath path;
  analysis::reliability::LimitForecast forecast;  // where the limit is not met yet
};
/// @param series  of kFewestCyclesOfTrend cycles at least. @param level  of the forecast's interval.
CampaignLimit LimitOf(const std::string& quantity, const ResultSeries& series, double limit, double level);

/// Of those quantities that have cycles enough. @param limits  by quantity. @throws DatabaseError.
std::vector<CampaignLimit> LimitForecasts(const Journal& journal, const std::map<std::string, double>& limits,
                                          double level);

}  // namespace strainwave::bench
