// SPDX-License-Identifier: Apache-2.0
#include "bench/life/stop_forecasts.h"

#include <algorithm>
#include <cmath>

namespace strainwave::bench {
namespace {

void Add(const CycleResult& row, ResultSeries& series) {
  if (row.cycle < 1 || !row.result.flag.empty() || !std::isfinite(row.result.value)) return;
  if (!series.cycle.empty() && series.cycle.back() == row.cycle) {
    series.value.back() = row.result.value;
    return;
  }
  series.cycle.push_back(row.cycle);
  series.value.push_back(row.result.value);
}

}  // namespace

double ResultSeries::AtFirst() const {
  const std::size_t count = std::min(kCyclesAtFirst, value.size());
  double sum = 0.0;
  for (std::size_t i = 0; i < count; ++i) sum += value[i];
  return sum / static_cast<double>(count);
}

std::map<std::string, ResultSeries> ResultSeriesOf(const Journal& journal) {
  std::map<std::string, ResultSeries> all;
  journal.ForEachResult("", [&](const CycleResult& row) {
    Add(row, all[row.result.quantity]);
    return true;
  });
  return all;
}

CampaignLimit LimitOf(const std::string& quantity, const ResultSeries& series, double limit, double level) {
  CampaignLimit of{quantity, series.AtFirst(), series.value.back(), limit, {}, {}, {}};
  for (std::size_t i = 0; i < series.value.size(); ++i) {
    const double way = (series.value[i] - of.first) / (limit - of.first);
    of.path.cycle.push_back(series.cycle[i]);
    of.path.way.push_back(way);
    if (way >= 1.0 && !of.met_at) of.met_at = static_cast<int>(series.cycle[i]);
  }
  if (!of.met_at) of.forecast = analysis::reliability::ForecastLimit(of.path, level);
  return of;
}

std::vector<CampaignLimit> LimitForecasts(const Journal& journal, const std::map<std::string, double>& limits,
                                          double level) {
  std::vector<std::string> limited;
  for (const auto& [quantity, limit] : limits) limited.push_back(quantity);
  std::map<std::string, ResultSeries> series;
  if (!limited.empty() && journal.LastCompleteCycle() > 0)
    journal.ForEachResultOf(limited, 1, journal.LastCompleteCycle(),
                            [&](const CycleResult& row) { Add(row, series[row.result.quantity]); });
  std::vector<CampaignLimit> all;
  for (const auto& [quantity, found] : series) {
    if (found.value.size() >= kFewestCyclesOfTrend)
      all.push_back(LimitOf(quantity, found, limits.at(quantity), level));
  }
  return all;
}

}  // namespace strainwave::bench
