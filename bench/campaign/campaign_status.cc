// SPDX-License-Identifier: Apache-2.0
#include "bench/campaign/campaign_status.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <utility>

#include "bench/campaign/campaign_alarms.h"
#include "bench/campaign/checkpoint.h"
#include "bench/campaign/cycle_steps.h"
#include "bench/campaign/life_share.h"
#include "bench/campaign/time_to_go.h"
#include "bench/campaign/unattended.h"
#include "bench/utc.h"
#include "schedules/reader/plan.h"

namespace strainwave::bench {
namespace {

constexpr int kEventsShown = 8;
constexpr int kNotesShown = 3;
// What the time to go is measured by: enough that one suspension does not matter, few enough to follow a
// bench that has changed.
constexpr int kCyclesMeasured = 50;
constexpr int kFewestMeasured = 5;

// Of the step of the newest row, all attempts together.
double CreditedInStep_s(const std::vector<PhaseRow>& rows) {
  double credited_s = 0.0;
  for (const PhaseRow& row : rows) {
    if (row.step == rows.back().step && row.repeat == rows.back().repeat) credited_s += row.credited_load_s;
  }
  return credited_s;
}

// Bench time a second of the world's, since the program that runs has begun.
std::optional<double> PaceOf(const RunBegun& begun, const Checkpoint& checkpoint) {
  const double world_s = PauseBetween(begun.moment(), checkpoint.written).length_s.value_or(0.0);
  constexpr double kLongEnough_s = 2.0;
  if (world_s < kLongEnough_s || checkpoint.time_s <= begun.time_s) return std::nullopt;
  return (checkpoint.time_s - begun.time_s) / world_s;
}

// What the phases of the cycle that is under way tell, with the checkpoint that may know more of the last
// one.
void TakePhases(const CampaignFolder& folder, const CampaignInputs& inputs, CampaignProgress& progress) {
  const std::vector<PhaseRow>& rows = progress.phases;
  progress.measured_again =
      static_cast<int>(std::ranges::count_if(rows, [](const PhaseRow& row) { return row.repeat > 0; }));
  if (!rows.empty()) {
    progress.phase = rows.back().name;
    progress.phase_outcome = rows.back().outcome;
    for (const PhaseRow& row : rows) progress.credited_load_s += row.credited_load_s;
  }
  progress.bench_time_s = progress.latest_s;
  double credited_in_step_s = rows.empty() ? 0.0 : CreditedInStep_s(rows);
  if (const auto checkpoint = ReadCheckpoint(folder.Checkpoint())) {
    progress.checkpoint_written = checkpoint->written;
    progress.bench_time_s = std::max(progress.bench_time_s, checkpoint->time_s);
    // A checkpoint that is older than the phase says nothing of it.
    const bool of_this_phase = !rows.empty() && checkpoint->cycle == rows.back().cycle &&
                               checkpoint->step == rows.back().step &&
                               checkpoint->repeat == rows.back().repeat;
    if (progress.phase_outcome == "running" && of_this_phase) {
      // What other load runs of the cycle have is in the rows; of this one the checkpoint knows more.
      progress.credited_load_s += checkpoint->credited_load_s - credited_in_step_s;
      credited_in_step_s = checkpoint->credited_load_s;
    }
    if (progress.process > 0 && progress.run_begun) progress.pace = PaceOf(*progress.run_begun, *checkpoint);
  }
  progress.remaining_s =
      TimeToGo_s(inputs.schedule, progress.cycle, rows, credited_in_step_s, progress.bench_time_s) *
      progress.as_planned.value_or(1.0);
  progress.phase_share =
      PhaseShare(inputs.schedule, progress.cycle, rows, credited_in_step_s, progress.bench_time_s);
}

void TakeReadings(const CampaignFolder& folder, const CampaignInputs& inputs, CampaignProgress& progress) {
  if (progress.process == 0) return;
  progress.readings = ReadLiveReadings(folder.Readings());
  if (!progress.readings) return;
  progress.live_taken = progress.readings->taken;
  progress.live_age_s = PauseBetween(*progress.live_taken, Now()).length_s;
  progress.live = LiveValues(*progress.readings, progress.live_age_s, inputs.schedule.limits, inputs.bench);
}

void TakeSources(const CampaignFolder& folder, const CampaignInputs& inputs, CampaignProgress& progress) {
  const auto live = ReadLiveSources(folder.Sources());
  progress.sources = SourceStates(inputs.bench, progress.bad_channels, live, progress.process > 0, Now());
  progress.sources_since_utc_ms = live ? live->since_utc_ms : 0;
}

}  // namespace

JournalProgress JournalProgressOf(const Journal& journal, const CampaignInputs& inputs) {
  JournalProgress progress;
  progress.last_complete = journal.LastCompleteCycle();
  progress.phases = journal.Phases(progress.last_complete + 1);
  progress.latest_s = journal.LatestTime_s();
  if (const auto begun = journal.Property(kRunBegun)) progress.run_begun = ParseRunBegun(*begun);
  progress.planned_s = TimeToGo_s(inputs.schedule, 0, {}, 0.0, 0.0);
  const double planned_cycle_s = PlannedDuration_s(StepsOf(inputs.schedule, 1));
  const auto cycle_s = journal.MeanCycle_s(kCyclesMeasured, kFewestMeasured);
  if (cycle_s && planned_cycle_s > 0.0) progress.as_planned = *cycle_s / planned_cycle_s;
  progress.planned_cycle_bytes = PlannedCycle_bytes(inputs.schedule);
  progress.events = journal.Events(kEventsShown);
  progress.last_of_bench = journal.LastEventOfBench();
  progress.unattended_restarts = UnattendedRestarts(journal);
  progress.alarms = journal.OpenAlarms();
  progress.open_alarms = journal.Alarms(std::numeric_limits<double>::infinity());
  progress.notes = journal.OperatorNotes(kNotesShown);
  progress.bad_channels = journal.ChannelTroubles();
  if (progress.last_complete <= 0) return progress;
  progress.last_results = journal.Results(progress.last_complete, 0);
  progress.stops = StopDistances(inputs.schedule.stop, FirstK2_Nm_per_rad(journal), progress.last_results);
  const auto plan = schedules::MakePlan(inputs.schedule, std::chrono::system_clock::now());
  progress.life_share = LifeShare(inputs.schedule.specimen, plan.once_load_blocks) +
                        LifeShare(inputs.schedule.specimen, plan.cycle_load_blocks) * progress.last_complete;
  return progress;
}

CampaignProgress ProgressOf(const CampaignFolder& folder, JournalProgress journal,
                            const CampaignInputs& inputs) {
  CampaignProgress progress;
  static_cast<JournalProgress&>(progress) = std::move(journal);
  progress.process = CampaignLock::Holder(folder);
  progress.complete = std::max(0, progress.last_complete);
  progress.cycles = inputs.schedule.cycles;
  progress.cycle = progress.last_complete + 1;
  progress.longest_pause_s = inputs.schedule.resume.longest_pause_s;
  progress.unattended_allowed = inputs.schedule.resume.unattended;
  TakePhases(folder, inputs, progress);
  TakeReadings(folder, inputs, progress);
  TakeSources(folder, inputs, progress);
  progress.room = DiskRoomOf(folder, progress.planned_cycle_bytes, progress.complete, progress.cycles);
  if (progress.room) {
    progress.disk_lasts_s = progress.room->Lasts_s(progress.planned_s / std::max(1, progress.cycles)) /
                            progress.pace.value_or(1.0);
  }
  TakeOffShelves(progress.open_alarms, Now());
  std::erase_if(progress.open_alarms, [](const AlarmInstance& alarm) { return !IsOpen(alarm.state); });
  progress.alarm_rules = inputs.bench.alarms;
  return progress;
}

CampaignStatus StatusOf(const CampaignFolder& folder, const Journal& journal, const CampaignInputs& inputs) {
  CampaignStatus status{ProgressOf(folder, JournalProgressOf(journal, inputs), inputs),
                        journal.Holes(),
                        {},
                        SamplesOf(journal)};
  status.checks = CheckHistories(inputs.schedule, CheckResultsIn(journal, inputs.schedule));
  return status;
}

std::optional<double> TimeToEnd_s(const CampaignProgress& progress) {
  if (!progress.pace) return std::nullopt;
  return progress.remaining_s / *progress.pace;
}

std::string EndUtc(const CampaignProgress& progress) {
  const auto to_end_s = TimeToEnd_s(progress);
  return to_end_s ? UtcText(UtcMilliseconds() + std::llround(1e3 * *to_end_s)) : std::string();
}

}  // namespace strainwave::bench
