// SPDX-License-Identifier: Apache-2.0
#include "bench/campaign/check_trends.h"

#include <cmath>

#include "analysis/units.h"
#include "bench/campaign/cycle_results.h"

namespace strainwave::bench {
namespace {

using schedules::SensorCheck;

std::string QuantityOf(const schedules::Phase& phase, const SensorCheck& check) {
  return phase.name + (check.kind == SensorCheck::Kind::kReference ? "_arcmin" : "_Nm");
}

}  // namespace

std::vector<TimedResults> CheckResultsIn(const Journal& journal, const schedules::Schedule& schedule) {
  std::vector<TimedResults> cycles;
  for (const schedules::Phase& phase : schedule.phases) {
    const auto* const check = std::get_if<SensorCheck>(&phase.parameters);
    if (check == nullptr) continue;
    const std::string quantity = QuantityOf(phase, *check);
    journal.ForEachResult(quantity, [&](const CycleResult& row) {
      if (row.result.quantity == quantity) cycles.push_back({row.ended_s / kDay_s, {row.result}});
      return true;
    });
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
    history.quantity = QuantityOf(phase, *check);
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
