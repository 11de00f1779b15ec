// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <chrono>
#include <memory>
#include <optional>

#include <fmt/chrono.h>
#include <fmt/core.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "analysis/bearing_life.h"
#include "analysis/units.h"
#include "bench/campaign/campaign.h"
#include "bench/campaign/life_share.h"
#include "bench/commands/commands.h"
#include "bench/commands/output.h"
#include "bench/commands/terminal.h"
#include "bench/configuration/sensors_of.h"
#include "bench/errors/bench_error.h"
#include "bench/life/planned_test.h"
#include "bench/life/times_report.h"
#include "bench/safety/interlocks.h"
#include "bench/trip_test/trip_row.h"
#include "schedules/reader/plan.h"

namespace strainwave::bench {
namespace {

struct ValidateOptions {
  std::string schedule;
  std::string bench;
  double show_life_h{};
  double confidence_percent{90.0};
  double shape{};
  bool json{};
};

struct LifePlan {
  double whole_share{};
  double cycle_share{};
  double peak_torque_Nm{};
  analysis::OverloadMargins margins;
};

LifePlan LifeOf(const schedules::Schedule& schedule, const schedules::Plan& plan) {
  LifePlan life;
  life.cycle_share = LifeShare(schedule.specimen, plan.cycle_load_blocks);
  life.whole_share = LifeShare(schedule.specimen, plan.once_load_blocks) + life.cycle_share * plan.cycles;
  for (const auto& blocks : {plan.once_load_blocks, plan.cycle_load_blocks}) {
    for (const auto& block : blocks)
      life.peak_torque_Nm = std::max(life.peak_torque_Nm, block.output_torque_Nm);
  }
  life.margins = analysis::MarginsAtPeak(RatingOf(schedule.specimen), life.peak_torque_Nm);
  return life;
}

void PrintPhases(const char* title, const std::vector<schedules::PhaseTime>& phases) {
  if (phases.empty()) return;
  ToStdout("{}\n", title);
  for (const auto& phase : phases) {
    ToStdout("  {:24} {:22} {:>14}{}\n", phase.name, phase.kind, DurationText(phase.total_s()),
             phase.at_most ? "  at most" : "");
  }
}

// A row of the table with what this schedule and this bench make of it.
struct Interlock : InterlockRow {
  double noticed_within_s{};
  bool latches{};
};

std::vector<Interlock> InterlocksOf(const CampaignInputs& inputs) {
  const std::vector<TripRow> trips = TripRows(TripSettingsOf(inputs.schedule), inputs.bench);
  std::vector<Interlock> interlocks;
  for (const InterlockRow& row : Interlocks::Table(SensorsOf(inputs.bench))) {
    Interlock interlock{row};
    for (const TripRow& trip : trips) {
      if (std::ranges::find(row.causes, trip.cause) == row.causes.end()) continue;
      interlock.noticed_within_s = std::max(interlock.noticed_within_s, trip.noticed_within_s);
      interlock.latches = interlock.latches || trip.latches;
    }
    interlocks.push_back(interlock);
  }
  return interlocks;
}

void PrintInterlocks(const std::vector<Interlock>& interlocks) {
  ToStdout("interlocks, watched every control period in every phase\n  {:27} {:39} {:>13}  {:7}  {}\n",
           "signal", "limit", "noticed after", "latch", "action");
  for (const auto& row : interlocks) {
    if (row.unwatched.empty())
      ToStdout("  {:27} {:39} {:>11.2f} s  {:7}  {}\n", row.signal, row.limit, row.noticed_within_s,
               row.latches ? "latches" : "no", row.action);
  }
  if (std::ranges::all_of(interlocks, &std::string_view::empty, &Interlock::unwatched)) return;
  ToStdout("not watched on this bench\n");
  for (const auto& row : interlocks) {
    if (!row.unwatched.empty()) ToStdout("  {:27} {:39} {}\n", row.signal, row.limit, row.unwatched);
  }
}

void PrintPlan(const schedules::Schedule& schedule, const schedules::Plan& plan, const LifePlan& life,
               const std::vector<Interlock>& interlocks) {
  ToStdout("{}: {} cycles on {} ({})\n\n", schedule.name, schedule.cycles, schedule.specimen.identity,
           schedule.specimen.model);
  PrintPhases("once, before the first cycle", plan.preparation);
  if (plan.repeats.total_s() > 0.0) {
    ToStdout("  {:24} {:22} {:>14}\n",
             fmt::format("measurements, {} times", schedule.measurements.repeatability_repeats),
             "repeatability", DurationText(plan.repeats.total_s()));
  }
  PrintPhases("each cycle", plan.phases);
  ToStdout("  {:47} {:>14}\n\n", "one cycle", DurationText(plan.cycle.total_s()));
  ToStdout("load time       {:>14}\n", DurationText(plan.load_s));
  ToStdout("measuring time  {:>14}\n", DurationText(plan.measuring_s));
  ToStdout("other time      {:>14}   ramps, soaks, locks\n", DurationText(plan.other_s));
  ToStdout("wall time       {:>14}   {:+.0f} % over the load time\n", DurationText(plan.wall_s),
           plan.load_s > 0.0 ? 100.0 * (plan.wall_s / plan.load_s - 1.0) : 0.0);
  ToStdout("expected end    {:%Y-%m-%d %H:%M} UTC, started now\n\n",
           fmt::gmtime(std::chrono::system_clock::to_time_t(plan.expected_end)));
  ToStdout("disk\n");
  for (const auto& stream : plan.streams) {
    ToStdout("  {:38} {:>10} rows a cycle {:>12}\n", stream.name, stream.rows_per_cycle,
             BytesText(static_cast<double>(stream.bytes_total)));
  }
  ToStdout("  {:38} {:>23} {:>12}\n\n", "together", "", BytesText(static_cast<double>(plan.disk_bytes)));
  const auto& specimen = schedule.specimen;
  ToStdout(
      "life\n  wave-generator bearing: {:.1f} % of L10 used by the whole campaign (cube law, Miner sum; "
      "{:.4f} % a "
      "cycle)\n",
      100.0 * life.whole_share, 100.0 * life.cycle_share);
  ToStdout(
      "  highest load {:.1f} Nm: ratcheting at {:.0f} Nm is {:.1f} times that, buckling at {:.0f} Nm {:.1f} "
      "times\n\n",
      life.peak_torque_Nm, specimen.ratcheting_torque_Nm, life.margins.ratcheting,
      specimen.buckling_torque_Nm, life.margins.buckling);
  PrintInterlocks(interlocks);
  ToStdout("\nafter a pause the test counts as the same for up to {}; longer needs --accept-pause\n",
           DurationText(schedule.resume.longest_pause_s));
  if (schedule.resume.unattended > 0) {
    ToStdout(
        "after a cut a service goes on without a person, at most {} times in a row; never after a fault or "
        "a stop\n",
        schedule.resume.unattended);
  }
}

nlohmann::json PhasesJson(const std::vector<schedules::PhaseTime>& phases) {
  nlohmann::json rows = nlohmann::json::array();
  for (const auto& phase : phases) {
    rows.push_back({{"name", phase.name}, {"kind", phase.kind}, {"duration_s", phase.total_s()}});
  }
  return rows;
}

nlohmann::json InterlocksJson(const std::vector<Interlock>& interlocks) {
  nlohmann::json rows = nlohmann::json::array();
  for (const auto& row : interlocks) {
    rows.push_back({{"signal", row.signal},
                    {"limit", row.limit},
                    {"action", row.action},
                    {"noticed_within_s", row.noticed_within_s},
                    {"latches", row.latches},
                    {"watched", row.unwatched.empty()}});
    if (!row.unwatched.empty()) rows.back()["why_not"] = row.unwatched;
  }
  return rows;
}

std::optional<PlannedTest> PlannedTestOf(const ValidateOptions& options, const schedules::Schedule& schedule,
                                         const LifePlan& life) {
  if (options.show_life_h <= 0.0) return std::nullopt;
  return PlanTest({.b10_h = options.show_life_h,
                   .confidence = options.confidence_percent / 100.0,
                   .shape = options.shape > 0.0 ? options.shape : CatalogueShape(),
                   .campaign_h = life.whole_share * schedule.specimen.bearing_l10_s / SecondsFromHours(1.0),
                   .cycles = schedule.cycles});
}

void PrintJson(const schedules::Schedule& schedule, const schedules::Plan& plan, const LifePlan& life,
               const std::vector<Interlock>& interlocks, const std::optional<PlannedTest>& planned) {
  nlohmann::json streams = nlohmann::json::array();
  for (const auto& stream : plan.streams) {
    streams.push_back(
        {{"name", stream.name}, {"rows_per_cycle", stream.rows_per_cycle}, {"bytes", stream.bytes_total}});
  }
  nlohmann::json document{
      {"valid", true},
      {"schedule", schedule.name},
      {"cycles", schedule.cycles},
      {"preparation", PhasesJson(plan.preparation)},
      {"phases", PhasesJson(plan.phases)},
      {"cycle_s", plan.cycle.total_s()},
      {"load_time_s", plan.load_s},
      {"measuring_time_s", plan.measuring_s},
      {"other_time_s", plan.other_s},
      {"wall_time_s", plan.wall_s},
      {"expected_end_utc", fmt::format("{:%Y-%m-%dT%H:%M:%SZ}",
                                       fmt::gmtime(std::chrono::system_clock::to_time_t(plan.expected_end)))},
      {"disk_bytes", plan.disk_bytes},
      {"streams", streams},
      {"bearing_life_share", life.whole_share},
      {"ratcheting_margin", life.margins.ratcheting},
      {"buckling_margin", life.margins.buckling},
      {"interlocks", InterlocksJson(interlocks)}};
  if (planned) document["show_life"] = JsonOf(*planned);
  ToStdout("{}\n", document.dump(2));
}

int Validate(const ValidateOptions& options) {
  const CampaignInputs inputs =
      ReadInputs(options.schedule,
                 options.bench.empty() ? std::nullopt : std::optional<std::filesystem::path>(options.bench));
  for (const auto& finding : WarningsOf(inputs).items()) {
    ToStderr("{}\n", schedules::FormatFinding(options.schedule, finding));
  }
  const schedules::Plan plan = schedules::MakePlan(inputs.schedule, std::chrono::system_clock::now());
  const LifePlan life = LifeOf(inputs.schedule, plan);
  const std::vector<Interlock> interlocks = InterlocksOf(inputs);
  const std::optional<PlannedTest> planned = PlannedTestOf(options, inputs.schedule, life);
  if (options.json) {
    PrintJson(inputs.schedule, plan, life, interlocks, planned);
  } else {
    PrintPlan(inputs.schedule, plan, life, interlocks);
    if (planned) ToStdout("{}", TextOf(*planned));
  }
  return static_cast<int>(ExitCode::kDone);
}

}  // namespace

void AddValidate(CLI::App& app, Action& action) {
  CLI::App* command = app.add_subcommand("validate",
                                         "Check a schedule and its bench, and print the plan: phases, "
                                         "durations, end, disk, life. Touches no device.\n"
                                         "Example: strainwave validate schedules/paper.yaml");
  auto options = std::make_shared<ValidateOptions>();
  command->add_option("SCHEDULE", options->schedule, "schedule file (YAML)")->required();
  command->add_option("--bench", options->bench,
                      "bench file (YAML); without it, the embedded simulated bench");
  command
      ->add_option("--show-life", options->show_life_h,
                   "h at the rated load: how many specimens, how long, to show that B10 is at least that")
      ->check(CLI::PositiveNumber);
  command->add_option("--confidence", options->confidence_percent, "% with which --show-life shows it")
      ->check(CLI::Range(50.0, 99.9))
      ->capture_default_str();
  command
      ->add_option("--shape", options->shape,
                   "of the Weibull law of --show-life (default: 1.17, the maker's L10 and L50)")
      ->check(CLI::PositiveNumber);
  command->add_flag("--json", options->json, "the plan as JSON on standard output");
  command->callback([options, &action] { action = [options] { return Validate(*options); }; });
}

}  // namespace strainwave::bench
