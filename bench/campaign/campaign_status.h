// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "bench/alarms/alarm_list.h"
#include "bench/campaign/campaign.h"
#include "bench/campaign/check_trends.h"
#include "bench/campaign/disk_room.h"
#include "bench/campaign/live_readings.h"
#include "bench/campaign/pause.h"
#include "bench/campaign/quality.h"
#include "bench/campaign/run_begun.h"
#include "bench/campaign/sample_totals.h"
#include "bench/campaign/source_states.h"

namespace strainwave::bench {

/// What the journal says of how far a campaign is: changes a few times a cycle.
struct JournalProgress {
  int last_complete{};           // cycle; −1: none
  std::vector<PhaseRow> phases;  // of the next one
  double latest_s{};
  double planned_s{};            // bench time of the whole campaign
  double planned_cycle_bytes{};  // raw data of one cycle
  /// Bench time that cycles take, over what they take as planned: of the newest 50, from the fifth on.
  std::optional<double> as_planned;
  std::optional<RunBegun> run_begun;
  int unattended_restarts{};  // since a person last began a run
  std::vector<Result> last_results;
  std::vector<StopDistance> stops;         // how far the last cycle is from ending the campaign
  std::optional<double> life_share;        // of the bearing's L10, used up by the complete cycles
  std::vector<Event> alarms;               // why the last run has ended; newest first
  std::vector<AlarmInstance> open_alarms;  // of all runs, oldest first
  std::vector<OperatorNote> notes;         // newest first
  std::vector<Event> events;               // newest first
  std::optional<Event> last_of_bench;      // the newest that no person has asked for
  std::vector<ChannelTrouble> bad_channels;
};

/// With what checkpoint, readings, lock and disk say now: what costs little, however many cycles there are.
struct CampaignProgress : JournalProgress {
  int process{};  // that runs it; 0: nobody does
  int complete{};
  int cycles{};
  int cycle{};  // the one that is under way, or next; 0: the preparation
  std::string phase{"none"};
  std::string phase_outcome;
  std::optional<double> phase_share;  // done of the phase, as planned
  double credited_load_s{};           // in the cycle that is under way
  double bench_time_s{};
  double remaining_s{};                      // bench time, as cycles have gone so far
  std::optional<double> pace;                // of bench time, against the world's, while it runs
  std::optional<Moment> checkpoint_written;  // nothing: there is none
  std::optional<Moment> live_taken;          // the newest readings, while it runs
  std::optional<double> live_age_s;          // nothing: not known
  std::optional<LiveReadings> readings;      // those
  std::vector<LiveValue> live;               // the same beside their limits
  std::vector<SourceState> sources;          // of readings
  std::int64_t sources_since_utc_ms{};       // from when on their samples are counted; 0: they are not
  std::optional<DiskRoom> room;
  double disk_lasts_s{};  // of the world's time where the pace is known, else bench time; with a room
  int measured_again{};   // in the cycle that is under way
  std::vector<AlarmRule> alarm_rules;  // the bench file's
  double longest_pause_s{};
  int unattended_allowed{};  // restarts without a person that the schedule allows in a row
};

/// The same with what takes longer the more cycles there are.
struct CampaignStatus : CampaignProgress {
  std::vector<Hole> holes;
  std::vector<CheckHistory> checks;
  std::map<std::string, SampleCount> samples;  // of the complete cycles, by source
};

/// @param journal  from OpenCampaign; @param inputs  frozen in its folder.
JournalProgress JournalProgressOf(const Journal& journal, const CampaignInputs& inputs);
CampaignProgress ProgressOf(const CampaignFolder& folder, JournalProgress journal,
                            const CampaignInputs& inputs);
CampaignStatus StatusOf(const CampaignFolder& folder, const Journal& journal, const CampaignInputs& inputs);

/// Of the world's time, until the planned end at the pace of the run; nothing where that is not known.
std::optional<double> TimeToEnd_s(const CampaignProgress& progress);
/// The planned end; empty where it is not known.
std::string EndUtc(const CampaignProgress& progress);

}  // namespace strainwave::bench
