// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "analysis/units.h"
#include "bench/campaign/journal.h"
#include "daq/acquisition/sensor_checks.h"
#include "schedules/reader/schedule.h"

namespace strainwave::bench {

/// Results of one cycle and when it ended, in bench time.
struct TimedResults {
  double time_days{};
  std::vector<Result> results;
};

/// The results of the schedule's sensor checks, check by check, in the order of cycles.
std::vector<TimedResults> CheckResultsIn(const Journal& journal, const schedules::Schedule& schedule);

/// How the results of one sensor check went over the campaign.
struct CheckHistory {
  std::string quantity;  // "zero_check_Nm"
  std::size_t checks{};
  Result last;
  daq::acquisition::CheckLimits limits;  // in the quantity's unit
  std::optional<daq::acquisition::CheckTrend> trend;
};

/// One for every sensor check of the schedule's cycle that has a result. Results beyond a limit are part of
/// the trend.
std::vector<CheckHistory> CheckHistories(const schedules::Schedule& schedule,
                                         std::span<const TimedResults> cycles);

}  // namespace strainwave::bench
