// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include <fmt/format.h>

#include "analysis/units.h"
#include "bench/report/number_text.h"
#include "bench/report/sections.h"

namespace strainwave::bench {
namespace {

std::string AtCycle(double cycle) { return std::isfinite(cycle) ? fmt::format("{:.0f}", cycle) : "never"; }

std::string ForecastWords(const CampaignLimit& limit) {
  if (limit.met_at) return fmt::format("met at cycle {}", *limit.met_at);
  if (!limit.forecast.is_approached) return "not approached: no forecast";
  return fmt::format("cycle {} ({} to {})", AtCycle(limit.forecast.cycle),
                     AtCycle(limit.forecast.interval.low), AtCycle(limit.forecast.interval.high));
}

// What the schedule asks for, whether measured or not.
std::vector<std::string> CriteriaWords(const schedules::StopCriteria& stop) {
  std::vector<std::string> words;
  if (stop.k2_below_share_of_first)
    words.push_back(fmt::format("It ends when K2 is below {:.4g} % of its first value.",
                                100.0 * *stop.k2_below_share_of_first));
  if (stop.e_max_above_rad)
    words.push_back(
        fmt::format("It ends when e_max is above {:.4g} arcmin.", ArcminFromRad(*stop.e_max_above_rad)));
  if (stop.vibration_rms_above_m_per_s2)
    words.push_back(fmt::format("It ends when an RMS of vibration is above {:.4g} m/s².",
                                *stop.vibration_rms_above_m_per_s2));
  return words;
}

}  // namespace

ReportSection ChecksSection(const CampaignSheet& sheet) {
  ReportSection section{"Sensor checks", {}};
  if (sheet.checks.empty()) {
    section.parts.emplace_back("The schedule checks no sensor.");
    return section;
  }
  ReportTable table{
      "sensor_checks",
      {"check", "times", "last", "expected", "allowed ±", "trend a day", "days to the limit", "flag"},
      {}};
  for (const CheckHistory& check : sheet.checks) {
    const std::string trend =
        check.trend ? With95({check.trend->slope_per_day, check.trend->slope_standard_error}) : "–";
    const std::string left =
        check.trend && check.trend->days_left ? fmt::format("{:.3g}", *check.trend->days_left) : "–";
    table.rows.push_back({HeadOf(check.quantity), std::to_string(check.checks),
                          With95({check.last.value, check.last.standard_error}),
                          FiveDigits(check.limits.expected), FiveDigits(check.limits.allowed), trend, left,
                          check.last.flag.empty() ? "good" : check.last.flag});
  }
  section.parts.emplace_back("Days are of bench time; ± is half the width of the 95 % interval.");
  section.parts.emplace_back(std::move(table));
  return section;
}

ReportSection StopSection(const CampaignSheet& sheet) {
  ReportSection section{"Stop criteria, and when they will be met", {}, true};
  const std::vector<std::string> criteria = CriteriaWords(sheet.inputs.schedule.stop);
  if (criteria.empty()) {
    section.parts.emplace_back("The schedule has no stop criterion: it ends with its last cycle.");
    return section;
  }
  for (const std::string& words : criteria) section.parts.emplace_back(words);
  if (!sheet.no_forecast.empty()) {
    section.parts.emplace_back("There is no forecast: " + sheet.no_forecast + ".");
    if (sheet.stops.empty()) return section;
    ReportTable now{"stop_criteria", {"quantity", "now", "ends", "limit"}, {}};
    for (const StopDistance& stop : sheet.stops)
      now.rows.push_back({HeadOf(stop.quantity), FiveDigits(stop.value), stop.is_lower ? "below" : "above",
                          FiveDigits(stop.limit)});
    section.parts.emplace_back(std::move(now));
    return section;
  }
  if (sheet.limits.empty()) {
    section.parts.emplace_back("None of these quantities was measured often enough for a forecast.");
    return section;
  }
  section.parts.emplace_back("Forecast of each from its own path over the cycles, with the 95 % interval.");
  ReportTable table{"stop_criteria", {"quantity", "first", "now", "limit", "met at"}, {}};
  for (const CampaignLimit& limit : sheet.limits)
    table.rows.push_back({HeadOf(limit.quantity), FiveDigits(limit.first), FiveDigits(limit.last),
                          FiveDigits(limit.limit), ForecastWords(limit)});
  section.parts.emplace_back(std::move(table));
  return section;
}

ReportSection VerifiedSection(const CampaignSheet& sheet) {
  return {"Whether it is still what was written", {"strainwave verify: " + sheet.verified}};
}

}  // namespace strainwave::bench
