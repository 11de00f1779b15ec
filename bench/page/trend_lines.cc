// SPDX-License-Identifier: Apache-2.0
#include "bench/page/trend_lines.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "bench/campaign/cycle_results.h"
#include "bench/campaign/quality.h"
#include "bench/life/stop_forecasts.h"

namespace strainwave::bench {
namespace {

using nlohmann::json;

// Looked at first; further cycles only for what has too few values in those.
constexpr int kFirstLook = 64;

struct Baseline {
  std::vector<double> values;
  int first_cycle{};
  int last_cycle{};
};

bool IsWhole(const Baseline& baseline) { return baseline.values.size() == kBaselineCycles; }

}  // namespace

std::map<std::string, BaselineLimits> BaselineLimitsOf(const Journal& journal,
                                                       std::span<const std::string> quantities) {
  std::map<std::string, Baseline> baselines;
  std::vector<std::string> wanted(quantities.begin(), quantities.end());
  for (const std::string& quantity : wanted) baselines[quantity];
  const int last = journal.LastCompleteCycle();
  for (int from = 1, to = kFirstLook; from <= last && !wanted.empty(); from = to + 1, to *= 4) {
    journal.ForEachResultOf(wanted, from, std::min(to, last), [&](const CycleResult& found) {
      Baseline& baseline = baselines.at(found.result.quantity);
      if (IsWhole(baseline) || !IsSound(found.result)) return;
      if (baseline.values.empty()) baseline.first_cycle = found.cycle;
      baseline.values.push_back(found.result.value);
      baseline.last_cycle = found.cycle;
    });
    std::erase_if(wanted, [&](const std::string& quantity) { return IsWhole(baselines.at(quantity)); });
  }
  std::map<std::string, BaselineLimits> all;
  for (const auto& [quantity, baseline] : baselines) {
    if (baseline.values.size() < kFewestBaselineCycles) continue;
    all[quantity] = {*analysis::IndividualsLimits(baseline.values), baseline.first_cycle, baseline.last_cycle,
                     static_cast<int>(baseline.values.size())};
  }
  return all;
}

nlohmann::json TrendLinesJson(const Journal& journal, const schedules::StopCriteria& stop,
                              std::span<const std::string> quantities) {
  const auto baselines = BaselineLimitsOf(journal, quantities);
  const auto first_k2 = stop.k2_below_share_of_first ? FirstK2_Nm_per_rad(journal) : std::nullopt;
  json lines = json::object();
  std::map<std::string, double> stop_limits;
  for (const std::string& quantity : quantities) {
    json& line = lines[quantity] = {{"stop", nullptr}, {"forecast", nullptr}, {"control", nullptr}};
    if (const auto limit = StopLimitOf(stop, first_k2, quantity)) {
      line["stop"] = {{limit->is_lower ? "below" : "above", limit->limit}};
      stop_limits[quantity] = limit->limit;
    }
    const auto baseline = baselines.find(quantity);
    if (baseline == baselines.end()) continue;
    const auto& [limits, first_cycle, last_cycle, cycles] = baseline->second;
    line["control"] = {{"lower", limits.lower},      {"centre", limits.centre},  {"upper", limits.upper},
                       {"first_cycle", first_cycle}, {"last_cycle", last_cycle}, {"cycles", cycles}};
  }
  constexpr double kLevel = 0.95;
  const auto number = [](double cycle) { return std::isfinite(cycle) ? json(cycle) : json(); };
  for (const CampaignLimit& limit : LimitForecasts(journal, stop_limits, kLevel)) {
    if (!limit.forecast.is_approached) continue;
    lines[limit.quantity]["forecast"] = {{"cycle", number(limit.forecast.cycle)},
                                         {"low", number(limit.forecast.interval.low)},
                                         {"high", number(limit.forecast.interval.high)},
                                         {"level", kLevel}};
  }
  return lines;
}

}  // namespace strainwave::bench
