// SPDX-License-Identifier: Apache-2.0
#include <map>
#include <memory>

#include <fmt/core.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "bench/campaign/acquisition_results.h"
#include "bench/campaign/campaign.h"
#include "bench/campaign/campaign_error.h"
#include "bench/campaign/cycle_results.h"
#include "bench/commands/check_report.h"
#include "bench/commands/commands.h"
#include "bench/commands/output.h"
#include "bench/commands/results_table.h"
#include "bench/commands/terminal.h"
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
  double remaining_s{};  // bench time, as planned
  std::vector<Result> last_results;
  std::vector<Event> alarms;
  std::vector<Event> events;
  std::vector<ChannelTrouble> bad_channels;
  std::vector<Hole> holes;
  std::vector<CheckHistory> checks;
  std::map<std::string, SampleCount> samples;  // of the complete cycles, by source
  double longest_pause_s{};
};

Status StatusOf(const CampaignFolder& folder) {
  const Journal journal = OpenCampaign(folder, Database::Mode::kReadOnly);
  for (const std::string& doubt : DoubtsAbout(folder, journal)) ToStderr("{}\n", doubt);
  const CampaignInputs inputs = ReadFrozenInputs(folder);
  Status status;
  status.process = CampaignLock::Holder(folder);
  status.complete = std::max(0, journal.LastCompleteCycle());
  status.cycles = inputs.schedule.cycles;
  status.longest_pause_s = inputs.schedule.resume.longest_pause_s;
  const auto rows = journal.Phases(journal.LastCompleteCycle() + 1);
  if (!rows.empty()) {
    status.phase = rows.back().name;
    status.phase_outcome = rows.back().outcome;
    for (const PhaseRow& row : rows) status.credited_load_s += row.credited_load_s;
  }
  status.bench_time_s = journal.LatestTime_s();
  if (const auto checkpoint = ReadCheckpoint(folder.Checkpoint())) {
    status.bench_time_s = std::max(status.bench_time_s, checkpoint->time_s);
    // A checkpoint that is older than the phase says nothing of it.
    const bool of_this_phase = !rows.empty() && checkpoint->cycle == rows.back().cycle &&
                               checkpoint->step == rows.back().step &&
                               checkpoint->repeat == rows.back().repeat;
    if (status.phase_outcome == "running" && of_this_phase)
      status.credited_load_s = checkpoint->credited_load_s;
  }
  const auto plan = schedules::MakePlan(inputs.schedule, std::chrono::system_clock::now());
  status.remaining_s = plan.cycle.total_s() * (status.cycles - status.complete);
  if (status.complete > 0) status.last_results = journal.Results(status.complete, 0);
  status.events = journal.Events(kEventsShown);
  for (const Event& event : journal.Events(1000)) {
    if (event.code == "resume" || event.code == "completed")
      break;  // a later start has answered what was before
    if (event.severity == "alarm") status.alarms.push_back(event);
  }
  status.bad_channels = journal.ChannelTroubles();
  status.holes = journal.Holes();
  status.samples = SamplesOf(journal);
  status.checks = CheckHistories(inputs.schedule, CheckResultsIn(journal, inputs.schedule));
  return status;
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
  ToStdout("  bench time   {} so far, about {} to go\n", DurationText(status.bench_time_s),
           DurationText(status.remaining_s));
  for (const Result& result : status.last_results) {
    ToStdout("  {:28} {:12.5g} ± {:.2g}{}\n", result.quantity, result.value, result.standard_error,
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
  for (const Event& alarm : status.alarms) ToStdout("  ALARM {}: {}\n", alarm.utc, alarm.text);
  ToStdout("  holes        {}; after a pause of up to {} it counts as the same test\n", status.holes.size(),
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
  return {{"running", status.process > 0},
          {"process", status.process},
          {"cycles_complete", status.complete},
          {"cycles", status.cycles},
          {"phase", status.phase},
          {"phase_outcome", status.phase_outcome},
          {"credited_load_s", status.credited_load_s},
          {"bench_time_s", status.bench_time_s},
          {"eta_s", status.remaining_s},
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
