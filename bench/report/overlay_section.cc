// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include <fmt/format.h>

#include "analysis/interval_95.h"
#include "bench/plots/gnuplot.h"
#include "bench/report/number_text.h"
#include "bench/report/sections.h"
#include "bench/report/trend_panels.h"

namespace strainwave::bench {
namespace {

// Of the first campaign, those that all others have.
std::vector<std::string> CommonQuantities(std::span<const CampaignSheet> sheets) {
  std::vector<std::string> common = MainQuantities(sheets.front());
  std::erase_if(common, [&](const std::string& name) {
    return !std::ranges::all_of(sheets,
                                [&](const CampaignSheet& sheet) { return sheet.series.contains(name); });
  });
  return common;
}

ReportTable DifferencesTable(std::span<const CampaignSheet> sheets,
                             const std::vector<std::string>& quantities) {
  ReportTable table{"differences", {"quantity"}, {}};
  const std::string first = "1 " + sheets.front().name;
  table.heads.push_back(first);
  for (std::size_t i = 1; i < sheets.size(); ++i)
    table.heads.push_back(fmt::format("{} {} less {}", i + 1, sheets[i].name, first));
  for (const std::string& quantity : quantities) {
    const analysis::Estimate& base = sheets.front().series.at(quantity).value.back();
    std::vector<std::string> row{HeadOf(quantity), With95(base)};
    for (const CampaignSheet& sheet : sheets.subspan(1))
      row.push_back(With95(analysis::ChangeBetween(base, sheet.series.at(quantity).value.back())));
    table.rows.push_back(std::move(row));
  }
  return table;
}

}  // namespace

ReportSection OverlaySection(std::span<const CampaignSheet> sheets, std::vector<std::string>& warnings) {
  ReportSection section{"Beside each other", {}};
  ReportTable who{"campaigns", {"no.", "campaign", "specimen", "schedule", "cycles", "load (h)"}, {}};
  bool differ = false;
  for (std::size_t i = 0; i < sheets.size(); ++i) {
    const CampaignSheet& sheet = sheets[i];
    const schedules::Schedule& schedule = sheet.inputs.schedule;
    who.rows.push_back({std::to_string(i + 1), sheet.name, schedule.specimen.identity, schedule.name,
                        std::to_string(sheet.complete), FiveDigits(sheet.load_s / 3600.0)});
    differ |= sheet.properties.at("schedule_sha256") != sheets.front().properties.at("schedule_sha256");
  }
  section.parts.emplace_back(std::move(who));
  if (differ) section.parts.emplace_back("Their schedules are not the same file: compare them below.");
  const std::vector<std::string> quantities = CommonQuantities(sheets);
  if (quantities.empty()) {
    section.parts.emplace_back("No quantity was measured in all of them.");
    return section;
  }
  section.parts.emplace_back("Last cycle of each, ± half the width of the 95 % interval.");
  section.parts.emplace_back(DifferencesTable(sheets, quantities));
  try {
    for (std::string& svg : DrawTrendPanels(sheets, quantities))
      section.parts.emplace_back(ReportPicture{std::move(svg), "Line: value; band: its 95 % interval."});
  } catch (const GnuplotError& error) {
    section.parts.emplace_back(fmt::format("The trends could not be drawn: {}", error.what()));
    warnings.push_back(fmt::format("warning: no trends: {}", error.what()));
  }
  return section;
}

}  // namespace strainwave::bench
