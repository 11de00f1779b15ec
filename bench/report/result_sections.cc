// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <set>

#include <fmt/format.h>

#include "analysis/interval_95.h"
#include "analysis/units.h"
#include "bench/plots/gnuplot.h"
#include "bench/report/number_text.h"
#include "bench/report/sections.h"
#include "bench/report/trend_panels.h"

namespace strainwave::bench {
namespace {

constexpr int kCyclesShown = 25;
constexpr std::size_t kColumns_a_table = 5;
constexpr std::size_t kOrdersShown = 12;

// First, last, and every n-th.
std::vector<int> CyclesOfTable(int complete, int& step) {
  step = std::max(1, (complete + kCyclesShown - 2) / (kCyclesShown - 1));
  std::vector<int> cycles;
  for (int cycle = 1; cycle < complete; cycle += step) cycles.push_back(cycle);
  cycles.push_back(complete);
  return cycles;
}

// Of the last measurement of a cycle, where it was taken again.
const analysis::Estimate* ValueIn(const QuantitySeries& series, int cycle, std::string& flag) {
  const auto after = std::ranges::upper_bound(series.cycle, cycle);
  if (after == series.cycle.begin() || *std::prev(after) != cycle) return nullptr;
  const auto at = static_cast<std::size_t>(std::prev(after) - series.cycle.begin());
  flag = series.flag[at];
  return &series.value[at];
}

std::string JudgedByGauge(const CampaignSheet& sheet, const std::string& quantity, double change) {
  const auto limit = sheet.repeatability_limits.find(quantity);
  if (limit == sheet.repeatability_limits.end()) return "gauge not measured";
  return std::abs(change) > limit->second ? "larger than the gauge" : "within the gauge";
}

std::string ControlLimitsText(const CampaignSheet& sheet, const std::string& quantity) {
  const auto found = sheet.control_limits.find(quantity);
  if (found == sheet.control_limits.end()) return "–";
  return fmt::format("{} to {}", FiveDigits(found->second.limits.lower),
                     FiveDigits(found->second.limits.upper));
}

std::string GaugeOf(const CampaignSheet& sheet, const std::string& quantity) {
  const auto limit = sheet.repeatability_limits.find(quantity);
  return limit == sheet.repeatability_limits.end() ? "–" : fmt::format("{:.3g}", limit->second);
}

ReportTable OrdersTable(const CampaignSheet& sheet) {
  ReportTable table{
      "orders",
      {"order of the output", "order of the input", "source", "first cycle (arcsec)", "last cycle (arcsec)"},
      {}};
  const auto arcsec = [](const analysis::Estimate& amplitude_rad) {
    return With95({ArcsecFromRad(amplitude_rad.value), ArcsecFromRad(amplitude_rad.standard_error)});
  };
  for (const auto& [first, last] : sheet.orders) {
    if (table.rows.size() == kOrdersShown) break;
    table.rows.push_back({fmt::format("{:.6g}", first.order_per_output_rev),
                          fmt::format("{:.4g}", first.order_per_input_rev),
                          first.name.empty() ? "not named" : first.name, arcsec(first.amplitude_rad),
                          last ? arcsec(last->amplitude_rad) : "–"});
  }
  return table;
}

}  // namespace

ReportSection ChangesSection(const CampaignSheet& sheet) {
  ReportSection section{"What has changed", {}};
  if (sheet.complete < 2) {
    section.parts.emplace_back("One cycle is complete: there is no change to tell.");
    return section;
  }
  section.parts.emplace_back(
      "First and last cycle that have the quantity, ± half width of the 95 % interval, which holds "
      "repeatability and "
      "calibration. What both cycles share, as a calibration, is in the interval of the change, too: it is "
      "rather too "
      "wide. The gauge's limit is by how much two measurements of one state differ in 5 of 100 cases. "
      "Control limits are "
      "those of the first cycles.");
  ReportTable table{
      "changes",
      {"quantity", "first", "last", "change", "gauge's limit (95 %)", "change is", "control limits"},
      {}};
  for (const std::string& quantity : MainQuantities(sheet)) {
    const QuantitySeries& series = sheet.series.at(quantity);
    const analysis::Estimate change = analysis::ChangeBetween(series.value.front(), series.value.back());
    table.rows.push_back({HeadOf(quantity), With95(series.value.front()), With95(series.value.back()),
                          With95(change), GaugeOf(sheet, quantity),
                          JudgedByGauge(sheet, quantity, change.value), ControlLimitsText(sheet, quantity)});
  }
  section.parts.emplace_back(std::move(table));
  if (sheet.repeatability_limits.empty())
    section.parts.emplace_back(
        "No measurement was repeated before the first cycle: how well the gauge repeats is not known.");
  if (sheet.control_limits.empty())
    section.parts.emplace_back(fmt::format(
        "There are no control limits: they need {} cycles with sound values.", kFewestBaselineCycles));
  return section;
}

ReportSection CyclesSection(const CampaignSheet& sheet) {
  ReportSection section{"Results over cycles", {}};
  int step = 1;
  const std::vector<int> cycles = CyclesOfTable(sheet.complete, step);
  section.parts.emplace_back(fmt::format(
      "± is half the width of the 95 % interval; an asterisk marks a result with a flag.{}",
      step == 1 ? std::string()
                : fmt::format(" One in {} of {} cycles, and the last; cycles.csv of --csv has all of them.",
                              step, sheet.complete)));
  const std::vector<std::string> names = MainQuantities(sheet);
  std::set<std::string> flags;
  for (std::size_t from = 0; from < names.size(); from += kColumns_a_table) {
    const std::size_t to = std::min(names.size(), from + kColumns_a_table);
    ReportTable table{{}, {"cycle"}, {}};
    for (std::size_t k = from; k < to; ++k) table.heads.push_back(HeadOf(names[k]));
    for (const int cycle : cycles) {
      std::vector<std::string> row{std::to_string(cycle)};
      for (std::size_t k = from; k < to; ++k) {
        std::string flag;
        const analysis::Estimate* const value = ValueIn(sheet.series.at(names[k]), cycle, flag);
        row.push_back(value == nullptr ? "–" : With95(*value) + (flag.empty() ? "" : " *"));
        if (!flag.empty()) flags.insert(flag);
      }
      table.rows.push_back(std::move(row));
    }
    section.parts.emplace_back(std::move(table));
  }
  for (const std::string& flag : flags) section.parts.emplace_back("* " + flag);
  return section;
}

ReportSection TrendsSection(const CampaignSheet& sheet, std::vector<std::string>& warnings) {
  ReportSection section{"Trends", {}, true};
  if (sheet.complete < 2) {
    section.parts.emplace_back("One cycle is complete: there is no trend to draw.");
    return section;
  }
  const std::span<const CampaignSheet> one(&sheet, 1);
  try {
    for (std::string& svg : DrawTrendPanels(one, MainQuantities(sheet)))
      section.parts.emplace_back(ReportPicture{std::move(svg),
                                               "Line: value; band: its 95 % interval; dotted: control "
                                               "limits; dashed: stop criterion, where it is near."});
  } catch (const GnuplotError& error) {
    section.parts.emplace_back(fmt::format("The trends could not be drawn: {}", error.what()));
    warnings.push_back(fmt::format("warning: no trends: {}", error.what()));
  }
  return section;
}

ReportSection CurvesSection(const CampaignSheet& sheet) {
  ReportSection section{"First and last measurement", {}, true};
  const std::string cycles = sheet.complete > 1 ? "the first and the last cycle" : "the first cycle";
  if (!sheet.no_pictures.empty()) {
    section.parts.emplace_back("They could not be drawn: " + sheet.no_pictures);
    return section;
  }
  if (sheet.hysteresis_svg.empty()) {
    section.parts.emplace_back("The schedule has no hysteresis test: there is no loop.");
  } else {
    section.parts.emplace_back(ReportPicture{
        sheet.hysteresis_svg, "Hysteresis of " + cycles + ": one loop, with its fit and K1 to K3."});
  }
  if (sheet.transmission_error_svg.empty()) {
    section.parts.emplace_back(
        "The schedule does not measure the transmission error: there is no order spectrum.");
    return section;
  }
  section.parts.emplace_back(ReportPicture{sheet.transmission_error_svg,
                                           "Transmission error of " + cycles + " and its order spectrum."});
  section.parts.emplace_back(OrdersTable(sheet));
  return section;
}

}  // namespace strainwave::bench
