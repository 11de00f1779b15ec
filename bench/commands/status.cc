// SPDX-License-Identifier: Apache-2.0
#include <cinttypes>
#include <cmath>
#include <cstdio>
#include <map>
#include <memory>
#include <optional>

#include <fmt/core.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "bench/campaign/acquisition_results.h"
#include "bench/campaign/campaign.h"
#include "bench/campaign/cycle_results.h"
#include "bench/campaign/disk_room.h"
#include "bench/campaign/life_share.h"
#include "bench/campaign/live_readings.h"
#include "bench/campaign/quality.h"
#include "bench/campaign/time_to_go.h"
#include "bench/commands/check_report.h"
#include "bench/commands/commands.h"
#include "bench/commands/error_text.h"
#include "bench/commands/output.h"
#include "bench/commands/results_table.h"
#include "bench/commands/terminal.h"
#include "bench/errors/bench_error.h"
#include "bench/utc.h"
#include "schedules/reader/plan.h"

namespace strainwave::bench {
namespace {

constexpr int kEventsShown = 8;

struct StatusOptions {
  std::string folder;
  bool json{};
};

struct Status {
  int process{};
  int complete{};
  int cycles{};
  std::string phase{"none"};
  std::string phase_outcome;
  double credited_load_s{};
  double bench_time_s{};
  double remaining_s{};              // bench time, as planned
  std::optional<double> pace;        // of bench time, against the world's, while it runs
  std::string live_utc;              // of the newest readings, while it runs; empty: there are none
  std::optional<double> live_age_s;  // nothing: not known
  std::vector<LiveValue> live;
  std::vector<StopDistance> stops;   // how far the last cycle is from ending the campaign
  std::optional<double> life_share;  // of the bearing's L10, used up by the complete cycles
  std::optional<DiskRoom> little_room;
  int measured_again{};  // in the cycle that is under way
  std::vector<Result> last_results;
  std::vector<Event> alarms;
  std::vector<Event> events;
  std::vector<ChannelTrouble> bad_channels;
  std::vector<Hole> holes;
  std::vector<CheckHistory> checks;
  std::map<std::string, SampleCount> samples;  // of the complete cycles, by source
  double longest_pause_s{};
};

// Of the step of the newest row, all attempts together.
double CreditedInStep_s(const std::vector<PhaseRow>& rows) {
  double credited_s = 0.0;
  for (const PhaseRow& row : rows) {
    if (row.step == rows.back().step && row.repeat == rows.back().repeat) credited_s += row.credited_load_s;
  }
  return credited_s;
}

// Bench time a second of the world's, since the program that runs has begun.
std::optional<double> PaceOf(const Journal& journal, const Checkpoint& checkpoint) {
  const auto begun = journal.Property(kRunBegun);
  std::int64_t utc_ms{};
  double time_s{};
  if (!begun || std::sscanf(begun->c_str(), "%" SCNd64 " %lf", &utc_ms, &time_s) != 2) return std::nullopt;
  const double world_s = 1e-3 * static_cast<double>(checkpoint.written.utc_ms - utc_ms);
  constexpr double kLongEnough_s = 2.0;
  if (world_s < kLongEnough_s || checkpoint.time_s <= time_s) return std::nullopt;
  return (checkpoint.time_s - time_s) / world_s;
}

std::string EndUtc(const Status& status) {
  if (!status.pace) return {};
  return UtcText(UtcMilliseconds() + std::llround(1e3 * status.remaining_s / *status.pace));
}

Status StatusOf(const CampaignFolder& folder) {
  const Journal journal = OpenCampaign(folder, Database::Mode::kReadOnly);
  for (const std::string& warning : WarningsAbout(folder, journal)) ToStderr("{}\n", warning);
  const CampaignInputs inputs = ReadFrozenInputs(folder, journal);
  Status status;
  status.process = CampaignLock::Holder(folder);
  status.complete = std::max(0, journal.LastCompleteCycle());
  status.cycles = inputs.schedule.cycles;
  status.longest_pause_s = inputs.schedule.resume.longest_pause_s;
  const int cycle = journal.LastCompleteCycle() + 1;
  const auto rows = journal.Phases(cycle);
  status.measured_again =
      static_cast<int>(std::ranges::count_if(rows, [](const PhaseRow& row) { return row.repeat > 0; }));
  if (!rows.empty()) {
    status.phase = rows.back().name;
    status.phase_outcome = rows.back().outcome;
    for (const PhaseRow& row : rows) status.credited_load_s += row.credited_load_s;
  }
  status.bench_time_s = journal.LatestTime_s();
  double credited_in_step_s = rows.empty() ? 0.0 : CreditedInStep_s(rows);
  if (const auto checkpoint = ReadCheckpoint(folder.Checkpoint())) {
    status.bench_time_s = std::max(status.bench_time_s, checkpoint->time_s);
    // A checkpoint that is older than the phase says nothing of it.
    const bool of_this_phase = !rows.empty() && checkpoint->cycle == rows.back().cycle &&
                               checkpoint->step == rows.back().step &&
                               checkpoint->repeat == rows.back().repeat;
    if (status.phase_outcome == "running" && of_this_phase) {
      // What other load runs of the cycle have is in the rows; of this one the checkpoint knows more.
      status.credited_load_s += checkpoint->credited_load_s - credited_in_step_s;
      credited_in_step_s = checkpoint->credited_load_s;
    }
    if (status.process > 0) status.pace = PaceOf(journal, *checkpoint);
  }
  if (const auto readings = ReadLiveReadings(folder.Readings()); readings && status.process > 0) {
    status.live_utc = UtcText(readings->taken.utc_ms);
    status.live_age_s = PauseBetween(readings->taken, Now()).length_s;
    status.live = LiveValues(*readings, status.live_age_s, inputs.schedule.limits, inputs.bench);
  }
  status.remaining_s = TimeToGo_s(inputs.schedule, cycle, rows, credited_in_step_s, status.bench_time_s);
  if (status.complete > 0) {
    status.last_results = journal.Results(status.complete, 0);
    status.stops = StopDistances(inputs.schedule.stop, FirstK2_Nm_per_rad(journal), status.last_results);
    const auto plan = schedules::MakePlan(inputs.schedule, std::chrono::system_clock::now());
    status.life_share = LifeShare(inputs.schedule.specimen, plan.once_load_blocks) +
                        LifeShare(inputs.schedule.specimen, plan.cycle_load_blocks) * status.complete;
  }
  status.little_room = LittleRoom(folder, inputs.schedule, status.complete);
  status.events = journal.Events(kEventsShown);
  status.alarms = journal.OpenAlarms();
  status.bad_channels = journal.ChannelTroubles();
  status.holes = journal.Holes();
  status.samples = SamplesOf(journal);
  status.checks = CheckHistories(inputs.schedule, CheckResultsIn(journal, inputs.schedule));
  return status;
}

void PrintLive(const Status& status) {
  if (status.process == 0) return;
  const bool fresh = status.live_age_s && *status.live_age_s <= kOldestLive_s;
  ToStdout("  readings     {}\n",
           status.live_utc.empty() ? "– (none yet)"
           : fresh                 ? fmt::format("of {}, {:.1f} s ago", status.live_utc, *status.live_age_s)
                                   : fmt::format("– (the last are of {}, {}: stale)", status.live_utc,
                                 status.live_age_s ? DurationText(*status.live_age_s) + " ago" : "long ago"));
  if (!fresh) return;
  for (const LiveValue& live : status.live) {
    ToStdout("    {:16} {:>8} {:4}  {}\n", live.quantity,
             live.value ? fmt::format("{:.4g}", *live.value) : "–", live.unit,
             live.value ? fmt::format("stops at {:.4g}", live.limit) : live.missing);
  }
}

void Print(const Status& status, const CampaignFolder& folder) {
  ToStdout("{}: {}\n", folder.root.string(),
           status.process > 0                 ? fmt::format("running in process {}", status.process)
           : status.complete == status.cycles ? "complete"
                                              : "not running");
  ToStdout("  cycles       {} of {} complete\n", status.complete, status.cycles);
  if (!status.phase_outcome.empty()) {
    ToStdout("  phase        {} ({}), load credited in this cycle {:.0f} s\n", status.phase,
             status.phase_outcome, status.credited_load_s);
  }
  if (status.measured_again > 0) {
    ToStdout("  retries      {} measurement(s) of this cycle taken again\n", status.measured_again);
  }
  ToStdout("  bench time   {} so far, about {} to go\n", DurationText(status.bench_time_s),
           DurationText(status.remaining_s));
  if (status.pace) {
    ToStdout(
        "  end          about {:.16}Z, in {}{}\n", EndUtc(status),
        DurationText(status.remaining_s / *status.pace),
        std::abs(*status.pace - 1.0) < 0.1 ? "" : fmt::format(", at {:.3g} times real time", *status.pace));
  }
  PrintLive(status);
  for (const StopDistance& stop : status.stops) {
    ToStdout("  stops        when {} is {} {:.5g} {}; now {:.5g}\n", stop.quantity,
             stop.is_lower ? "below" : "above", stop.limit, stop.unit, stop.value);
  }
  if (status.life_share)
    ToStdout("  life         {:.3g} % of the bearing's L10\n", 100.0 * *status.life_share);
  for (const Result& result : status.last_results) {
    ToStdout("  {:28} {:12.5g} ± {}{}\n", result.quantity, result.value, ErrorText(result.standard_error),
             result.flag.empty() ? "" : "  " + result.flag);
  }
  for (const auto& [source, count] : status.samples) {
    ToStdout("  samples of {}: {:.0f} received, {:.0f} lost, in all complete cycles\n", source,
             count.received, count.lost);
  }
  if (!status.checks.empty()) ToStdout("sensor checks\n{}", CheckText(status.checks));
  for (const ChannelTrouble& bad : status.bad_channels) {
    ToStdout("  BAD CHANNEL {} {} {}: {}\n", bad.channel, status.process > 0 ? "since" : "at the end, since",
             bad.since_utc, bad.reason);
  }
  if (status.little_room && status.complete < status.cycles) {
    ToStdout("  LITTLE ROOM  {} are free, and the raw data of the cycles to come may take {}\n",
             BytesText(status.little_room->free_bytes), BytesText(status.little_room->needed_bytes));
  }
  for (const Event& alarm : status.alarms) ToStdout("  ALARM {}: {}\n", alarm.utc, alarm.text);
  ToStdout("  interrupted  {} time(s){}; after a pause of up to {} it counts as the same test\n",
           status.holes.size(),
           status.holes.empty()
               ? ""
               : fmt::format(", last at {} ({})", status.holes.back().start_utc, status.holes.back().cause),
           DurationText(status.longest_pause_s));
  for (const Event& event : status.events) {
    ToStdout("  {} cycle {} {}: {}\n", event.utc, event.cycle, event.severity, event.text);
  }
}

nlohmann::json Json(const Status& status) {
  nlohmann::json alarms = nlohmann::json::array();
  for (const Event& alarm : status.alarms) {
    alarms.push_back(
        {{"utc", alarm.utc}, {"code", alarm.code}, {"text", alarm.text}, {"cycle", alarm.cycle}});
  }
  nlohmann::json holes = nlohmann::json::array();
  for (const Hole& hole : status.holes) {
    holes.push_back({{"cycle", hole.cycle},
                     {"phase", hole.phase},
                     {"start_utc", hole.start_utc},
                     {"end_utc", hole.end_utc},
                     {"cause", hole.cause}});
  }
  nlohmann::json samples = nlohmann::json::object();
  for (const auto& [source, count] : status.samples) {
    samples[source] = {{"received", count.received}, {"lost", count.lost}};
  }
  nlohmann::json bad_channels = nlohmann::json::array();
  for (const ChannelTrouble& bad : status.bad_channels) {
    bad_channels.push_back({{"channel", bad.channel}, {"reason", bad.reason}, {"since_utc", bad.since_utc}});
  }
  nlohmann::json live;
  if (!status.live_utc.empty()) {
    live = {{"utc", status.live_utc},
            {"age_s", status.live_age_s ? nlohmann::json(*status.live_age_s) : nlohmann::json()},
            {"values", nlohmann::json::array()}};
    for (const LiveValue& value : status.live) {
      live["values"].push_back({{"quantity", value.quantity},
                                {"value", value.value ? nlohmann::json(*value.value) : nlohmann::json()},
                                {"limit", value.limit},
                                {"unit", value.unit},
                                {"missing", value.missing}});
    }
  }
  nlohmann::json stops = nlohmann::json::array();
  for (const StopDistance& stop : status.stops) {
    stops.push_back({{"quantity", stop.quantity},
                     {"value", stop.value},
                     {stop.is_lower ? "below" : "above", stop.limit},
                     {"unit", stop.unit}});
  }
  return {
      {"running", status.process > 0},
      {"process", status.process},
      {"cycles_complete", status.complete},
      {"cycles", status.cycles},
      {"phase", status.phase},
      {"phase_outcome", status.phase_outcome},
      {"credited_load_s", status.credited_load_s},
      {"bench_time_s", status.bench_time_s},
      {"eta_s", status.remaining_s},
      {"pace", status.pace ? nlohmann::json(*status.pace) : nlohmann::json()},
      {"expected_end_utc", status.pace ? nlohmann::json(EndUtc(status)) : nlohmann::json()},
      {"measured_again", status.measured_again},
      {"little_room", status.little_room ? nlohmann::json{{"free_bytes", status.little_room->free_bytes},
                                                          {"needed_bytes", status.little_room->needed_bytes}}
                                         : nlohmann::json()},
      {"live", std::move(live)},
      {"stop_criteria", std::move(stops)},
      {"life_share", status.life_share ? nlohmann::json(*status.life_share) : nlohmann::json()},
      {"last_results", CycleJson(status.complete, status.last_results)},
      {"samples", std::move(samples)},
      {"sensor_checks", CheckJson(status.checks)},
      {"bad_channels", std::move(bad_channels)},
      {"alarms", std::move(alarms)},
      {"holes", std::move(holes)},
      {"longest_pause_s", status.longest_pause_s}};
}

}  // namespace

void AddStatus(CLI::App& app, Action& action) {
  CLI::App* command = app.add_subcommand("status",
                                         "Progress, phase, time to go, last results, open alarms and "
                                         "interruptions of a campaign, running or not.\n"
                                         "Example: strainwave status campaigns/first");
  auto options = std::make_shared<StatusOptions>();
  command->add_option("DIR", options->folder, "the campaign's folder")->required();
  command->add_flag("--json", options->json, "JSON on standard output");
  command->callback([options, &action] {
    action = [options] {
      const CampaignFolder folder{options->folder};
      const Status status = StatusOf(folder);
      options->json ? ToStdout("{}\n", Json(status).dump(2)) : Print(status, folder);
      return static_cast<int>(ExitCode::kDone);
    };
  });
}

}  // namespace strainwave::bench
