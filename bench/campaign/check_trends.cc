// SPDX-License-Identifier: Apache-2.0
#include "bench/campaign/check_trends.h"

#include <cmath>

#include "analysis/units.h"
#include "bench/campaign/cycle_results.h"

namespace strainwave::bench {
namespace {

using schedules::SensorCheck;

constexpr double kDay_s = 86400.0;

}  // namespace

std::vector<TimedResults> TimedResultsOf(const Journal& journal) {
  std::vector<TimedResults> cycles;
  for (const CycleRow& row : journal.Cycles()) {
    if (row.cycle == 0 || row.outcome != "complete") continue;
    cycles.push_back({row.ended_s / kDay_s, journal.Results(row.cycle, 0)});
  }
  return cycles;
}

std::vector<CheckHistory> CheckHistories(const schedules::Schedule& schedule,
                                         std::span<const TimedResults> cycles) {
  std::vector<CheckHistory> histories;
  for (const schedules::Phase& phase : schedule.phases) {
    const auto* const check = std::get_if<SensorCheck>(&phase.parameters);
    if (check == nullptr) continue;
    const bool angle = check->kind == SensorCheck::Kind::kReference;
    CheckHistory history;
    history.quantity = phase.name + (angle ? "_arcmin" : "_Nm");
    std::vector<daq::acquisition::EarlierCheck> earlier;
    for (const TimedResults& cycle : cycles) {
      const auto result = FindResult(cycle.results, history.quantity);
      if (!result || !std::isfinite(result->value)) continue;
      history.last = *result;
      earlier.push_back({cycle.time_days, result->value});
    }
    if (earlier.empty()) continue;
    history.checks = earlier.size();
    history.limits.expected = angle ? earlier.front().mean : check->expected_Nm;
    history.limits.allowed = angle ? ArcminFromRad(check->allowed) : check->allowed;
    history.trend = daq::acquisition::TrendOf(earlier, history.limits);
    histories.push_back(std::move(history));
  }
  return histories;
}

}  // namespace strainwave::bench
