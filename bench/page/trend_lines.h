// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <span>
#include <string>

#include <nlohmann/json.hpp>

#include "analysis/control_chart.h"
#include "bench/campaign/journal.h"
#include "schedules/reader/schedule.h"

namespace strainwave::bench {

/// Control limits of a quantity from the first cycles whose value is sound (analysis::IndividualsLimits).
struct BaselineLimits {
  analysis::ControlLimits limits;
  int first_cycle{};
  int last_cycle{};
  int cycles{};  // whose values they are of
};

/// As many cycles make the limits, which stand from then on; while there are fewer, those there are.
inline constexpr int kBaselineCycles = 20;
inline constexpr int kFewestBaselineCycles = 10;

/// Of those quantities that have enough cycles. @throws DatabaseError.
std::map<std::string, BaselineLimits> BaselineLimitsOf(const Journal& journal,
                                                       std::span<const std::string> quantities);

/// What a trend is held against, by quantity: `stop` ({"below": …} or {"above": …}), `forecast` of when that
/// is met (cycle, low, high, level; null cycles: perhaps never) and `control` (lower, centre, upper,
/// first_cycle, last_cycle, cycles), each null where there is none. @throws DatabaseError.
nlohmann::json TrendLinesJson(const Journal& journal, const schedules::StopCriteria& stop,
                              std::span<const std::string> quantities);

}  // namespace strainwave::bench
