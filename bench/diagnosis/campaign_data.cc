// SPDX-License-Identifier: Apache-2.0
#include "bench/diagnosis/campaign_data.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "analysis/quantities.h"
#include "bench/campaign/cycle_results.h"
#include "daq/sensor_serials.h"

namespace strainwave::bench {
namespace {

namespace quantities = analysis::quantities;

constexpr std::array kDiagnosed{quantities::kK1,        quantities::kK2,   quantities::kK3,
                                quantities::kEAvg,      quantities::kEMax, quantities::kLostMotion,
                                quantities::kHysteresis};

std::string SerialsOf(const CampaignFolder& folder, int cycle) {
  const auto file = folder.CycleFile(cycle);
  if (!std::filesystem::exists(file)) return {};
  return fmt::format("{}", fmt::join(daq::ReadSensorSerials(file), " "));
}

}  // namespace

analysis::diagnosis::CampaignData CampaignDataOf(const CampaignFolder& folder, const Journal& journal) {
  analysis::diagnosis::CampaignData data;
  for (const analysis::Quantity& quantity : kDiagnosed)
    data.series.push_back({std::string(quantity.name), {}, {}});
  double load_time_s = 0.0;
  for (const CycleRow& row : journal.Cycles()) {
    if (row.outcome != "complete") continue;
    for (const PhaseRow& phase : journal.Phases(row.cycle)) load_time_s += phase.credited_load_s;
    if (row.cycle == 0) continue;
    const std::vector<Result> results = journal.Results(row.cycle, 0);
    data.cycle.push_back(row.cycle);
    data.time_s.push_back(row.ended_s);
    data.load_time_s.push_back(load_time_s);
    const auto temperature = FindResult(results, quantities::kGearTemperature.name);
    data.temperature_degC.push_back(temperature ? temperature->value : std::nan(""));
    data.sensor_serials.push_back(SerialsOf(folder, row.cycle));
    for (auto& series : data.series) {
      const auto result = FindResult(results, series.name);
      const bool good = result && IsSound(*result);
      series.value.push_back(good ? result->value : std::nan(""));
      series.standard_error.push_back(good ? result->standard_error : std::nan(""));
    }
  }
  std::erase_if(data.series, [](const auto& series) {
    return std::ranges::none_of(series.value, [](double value) { return std::isfinite(value); });
  });
  return data;
}

}  // namespace strainwave::bench
