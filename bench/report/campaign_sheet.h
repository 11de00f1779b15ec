// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "analysis/transmission_error.h"
#include "bench/campaign/campaign.h"
#include "bench/campaign/check_trends.h"
#include "bench/campaign/quality.h"
#include "bench/campaign/sample_totals.h"
#include "bench/campaign/trail.h"
#include "bench/integrity/campaign_integrity.h"
#include "bench/life/campaign_lives.h"
#include "bench/page/trend_lines.h"
#include "bench/report/load_history.h"

namespace strainwave::bench {

/// One quantity over the complete cycles that have it, as the journal keeps it.
struct QuantitySeries {
  std::vector<int> cycle;
  std::vector<analysis::Estimate> value;  // finite; standard errors
  std::vector<std::string> flag;          // empty: good
};

/// What a report tells of one campaign. Lists are oldest first.
struct CampaignSheet {
  std::string folder;  // as it was given
  std::string name;    // of the folder
  CampaignInputs inputs;
  std::map<std::string, std::string> properties;  // of the journal: started_utc, schedule_sha256, …
  int complete{};                                 // cycles
  double bench_time_s{};
  double load_s{};  // credited
  std::vector<Event> events;
  std::vector<OperatorNote> notes;
  std::vector<Hole> holes;
  std::map<std::string, SampleCount> samples;  // by source
  std::vector<AlarmInstance> alarms;
  std::vector<AlarmAction> alarm_actions;
  std::map<std::string, QuantitySeries> series;
  std::map<std::string, double> repeatability_limits;  // 95 % of one difference, by quantity
  std::map<std::string, BaselineLimits> control_limits;
  std::string cycles_csv;  // as `strainwave table` writes it
  std::vector<CheckHistory> checks;
  std::optional<double> first_k2_Nm_per_rad;
  std::vector<StopDistance> stops;  // of the last complete cycle
  std::vector<CampaignLimit> limits;
  std::string no_forecast;      // why not, in words; empty: `limits` holds forecasts
  CampaignIntegrity integrity;  // as `strainwave verify` finds it
  std::string verified;         // the same in a line
  std::vector<TrailEntry> trail;
  CutPhases cut;
  LoadHistory load;
  std::vector<LoadRunShare> load_runs;
  std::string hysteresis_svg;
  std::string transmission_error_svg;
  std::string no_pictures;  // why not, in words
  /// Orders of the first and the last cycle's transmission error, strongest of the first one first.
  std::vector<std::pair<analysis::OrderLine, std::optional<analysis::OrderLine>>> orders;
};

/// Quantities of a sheet in the order of the documents, without those that other methods read from the same
/// loops, and without counts of samples.
std::vector<std::string> MainQuantities(const CampaignSheet& sheet);

/// "K₁ (Nm/rad)" of "k1_Nm_per_rad".
std::string HeadOf(const std::string& quantity);

/// @param level  of the forecasts' intervals.
/// @param warnings  about files of the campaign, and what could not be drawn.
/// @throws BenchError, DatabaseError as OpenCampaign; BenchError for a campaign without a complete cycle.
CampaignSheet ReadCampaignSheet(const std::string& folder, double level, std::vector<std::string>& warnings);

}  // namespace strainwave::bench
