// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include "bench/report/document.h"

/// What is told of a campaign, section by section. What a campaign does not have is said in words.
namespace strainwave::bench {

ReportSection SubjectSection(const CampaignSheet& sheet);      // specimen, bench, version, hashes
ReportSection CalibrationSection(const CampaignSheet& sheet);  // sensors with their due dates
ReportSection ScheduleSection(const CampaignSheet& sheet);

ReportSection PeopleSection(const CampaignSheet& sheet);
ReportSection HolesSection(const CampaignSheet& sheet);
ReportSection KeptSection(const CampaignSheet& sheet);  // what could have been lost
ReportSection SamplesSection(const CampaignSheet& sheet);
ReportSection AlarmsSection(const CampaignSheet& sheet);
ReportSection EventsSection(const CampaignSheet& sheet);
ReportSection TrailSection(const CampaignSheet& sheet);

ReportSection LoadSection(const CampaignSheet& sheet);  // rainflow, Miner

ReportSection ChangesSection(const CampaignSheet& sheet);
ReportSection CyclesSection(const CampaignSheet& sheet);
ReportSection TrendsSection(const CampaignSheet& sheet, std::vector<std::string>& warnings);
ReportSection CurvesSection(const CampaignSheet& sheet);

ReportSection ChecksSection(const CampaignSheet& sheet);
ReportSection StopSection(const CampaignSheet& sheet);
ReportSection VerifiedSection(const CampaignSheet& sheet);

/// Several campaigns: who they are, trends overlaid, differences of the last cycles.
ReportSection OverlaySection(std::span<const CampaignSheet> sheets, std::vector<std::string>& warnings);

}  // namespace strainwave::bench
