// SPDX-License-Identifier: Apache-2.0
#include "bench/report/document.h"

#include <fmt/format.h>

#include "bench/report/sections.h"

namespace strainwave::bench {
namespace {

std::vector<ReportSection> SectionsOf(const CampaignSheet& sheet, std::vector<std::string>& warnings) {
  return {
      SubjectSection(sheet), ScheduleSection(sheet),    ChangesSection(sheet), TrendsSection(sheet, warnings),
      CyclesSection(sheet),  CurvesSection(sheet),      LoadSection(sheet),    StopSection(sheet),
      ChecksSection(sheet),  CalibrationSection(sheet), PeopleSection(sheet),  HolesSection(sheet),
      KeptSection(sheet),    SamplesSection(sheet),     AlarmsSection(sheet),  EventsSection(sheet),
      TrailSection(sheet),   VerifiedSection(sheet)};
}

// Of one campaign among several: which it is stands in titles and names of files.
void Number(std::size_t number, const CampaignSheet& sheet, ReportSection& section) {
  section.title = fmt::format("{} {}: {}", number, sheet.name, section.title);
  for (ReportPart& part : section.parts) {
    if (auto* const table = std::get_if<ReportTable>(&part); table != nullptr && !table->name.empty())
      table->name = fmt::format("{}_{}", number, table->name);
  }
}

}  // namespace

ReportDocument ReportDocumentOf(std::span<const CampaignSheet> sheets,
                                const std::vector<ReportSection>& filed, std::vector<std::string>& warnings) {
  ReportDocument document;
  if (sheets.size() == 1) {
    document.title = fmt::format("Life test of {}: {}", sheets.front().inputs.schedule.specimen.identity,
                                 sheets.front().name);
    document.sections = SectionsOf(sheets.front(), warnings);
    document.sections.insert(document.sections.end(), filed.begin(), filed.end());
    return document;
  }
  document.title = fmt::format("Life tests: {} campaigns", sheets.size());
  document.sections.push_back(OverlaySection(sheets, warnings));
  for (std::size_t i = 0; i < sheets.size(); ++i) {
    std::vector<ReportSection> sections = SectionsOf(sheets[i], warnings);
    sections.front().begins_page = true;
    for (ReportSection& section : sections) {
      Number(i + 1, sheets[i], section);
      document.sections.push_back(std::move(section));
    }
  }
  document.sections.insert(document.sections.end(), filed.begin(), filed.end());
  return document;
}

}  // namespace strainwave::bench
