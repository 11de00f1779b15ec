// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "bench/campaign/campaign.h"
#include "bench/campaign/runner_settings.h"
#include "bench/commands/bench_commands.h"
#include "bench/commands/output.h"
#include "bench/commands/person.h"
#include "bench/commands/terminal.h"
#include "bench/configuration/embedded_bench.h"
#include "bench/configuration/read_bench_file.h"
#include "bench/errors/bench_error.h"
#include "bench/errors/output_path.h"
#include "bench/escaped.h"
#include "bench/machines/make_machine.h"
#include "bench/trip_test/metal_trips.h"
#include "bench/trip_test/simulated_trips.h"
#include "bench/trip_test/trip_sheet.h"
#include "bench/trip_test/trip_test.h"
#include "bench/utc.h"
#include "daq/software.h"
#include "daq/whole_file.h"

namespace strainwave::bench {
namespace {

struct TripOptions {
  std::string bench;
  std::string schedule;
  std::vector<std::string> only;
  std::string out;
  bool yes{};
  bool json{};
};

struct TripInputs {
  BenchDescription bench;
  TripSettings settings;
};

TripInputs ReadTripInputs(const TripOptions& options) {
  if (!options.schedule.empty()) {
    const CampaignInputs inputs = ReadInputs(
        options.schedule,
        options.bench.empty() ? std::nullopt : std::optional<std::filesystem::path>(options.bench));
    return {inputs.bench, TripSettingsOf(inputs.schedule)};
  }
  const BenchDescription bench = options.bench.empty() ? EmbeddedBench() : ReadBenchFile(options.bench);
  if (bench.simulated) return {bench, TripSettingsOf(bench)};
  throw BenchError(
      ExitCode::kWrongInput,
      fmt::format("{}: error: the limits of a bench of metal are a schedule's (expected --schedule "
                  "FILE)",
                  options.bench));
}

// A sheet that was filed is not written over.
void RefuseExisting(const std::string& out) {
  if (out.empty() || !std::filesystem::exists(out)) return;
  throw BenchError(ExitCode::kWrongInput,
                   fmt::format("--out {}: error: the file is there already (expected a new name: a sheet is "
                               "kept)",
                               out));
}

void AskForClearShafts(const TripOptions& options) {
  if (options.yes) return;
  if (Ask("the shafts will turn slowly, and be stopped again and again: keep clear, have the emergency stop "
          "at "
          "hand")) {
    return;
  }
  throw BenchError(ExitCode::kInterrupted,
                   "nobody has confirmed, nothing was moved (expected a person at the terminal, or --yes)");
}

TripPerson PersonAt(const BenchMachine& machine, const TripOptions& options) {
  TripPerson person;
  if (!options.yes) {
    person.ask = [](const std::string& what) {
      std::optional<std::string> why_not = AskOrWhyNot(what);
      if (why_not) why_not = Escaped(*why_not);
      return why_not;
    };
  }
  person.tell = [](const std::string& what) { ToStderr("{}\n", what); };
  person.wait_until_ready = [&machine] { WaitForPeople(machine); };
  person.given_up = [] { return Requested() != StopRequest::kNone; };
  return person;
}

std::vector<TripResult> Test(const TripInputs& inputs, const std::vector<TripRow>& rows,
                             const TripOptions& options) {
  RunnerSettings runner = RunnerSettingsOf(inputs.bench);
  runner.limits = inputs.settings.limits;
  runner.suspend = inputs.settings.suspend;
  TerminalLine line;
  const auto on_row = [&](std::size_t row) {
    const std::string text = fmt::format("row {} of {}: {}", row + 1, rows.size(), rows[row].signal);
    if (StderrIsTerminal()) {
      line.Show(text);
    } else {
      ToStderr("{}\n", text);
    }
  };
  if (inputs.bench.simulated) {
    SimulatedTrips trips(inputs.bench, inputs.settings);
    return RunTripTest(rows, trips, inputs.settings, runner, Requested(), on_row);
  }
  AskForClearShafts(options);
  SimulatedTest test;
  test.ratio = inputs.settings.specimen.ratio;
  const std::unique_ptr<BenchMachine> machine = MakeMachine(inputs.bench, test, Ask);
  WaitForPeople(*machine);
  WaitForValues(*machine);
  MetalTrips trips(*machine, inputs.bench, PersonAt(*machine, options));
  return RunTripTest(rows, trips, inputs.settings, runner, Requested(), on_row);
}

int TripTest(const TripOptions& options) {
  RefuseExisting(options.out);
  if (!options.out.empty()) DemandOutputFile(options.out);
  const TripInputs inputs = ReadTripInputs(options);
  const std::vector<TripRow> rows = OnlyRows(TripRows(inputs.settings, inputs.bench), options.only);
  ListenForQuickStop();
  TripSheet sheet{inputs.bench.name,
                  options.bench,
                  inputs.bench.simulated,
                  options.schedule,
                  UtcNow(),
                  std::string(daq::Software()),
                  rows,
                  {}};
  {
    const LiveOutput output([] { return Requested() != StopRequest::kNone; });
    sheet.results = Test(inputs, rows, options);
  }
  const std::string document = SheetJson(sheet).dump(2) + "\n";
  ToStdout("{}", options.json ? document : SheetText(sheet));
  if (!options.out.empty()) daq::WriteFileAtomically(options.out, document);
  // A person stopped it, here or by a key at the bench.
  const auto cut = [](const TripResult& result) {
    return result.verdict == TripVerdict::kSkipped && !result.stopped_as.empty();
  };
  if (Requested() != StopRequest::kNone || std::ranges::any_of(sheet.results, cut)) {
    return static_cast<int>(ExitCode::kInterrupted);
  }
  return static_cast<int>(IsGood(sheet) ? ExitCode::kDone : ExitCode::kEndedBadly);
}

}  // namespace

void AddBenchTripTest(CLI::App& bench, Action& action) {
  CLI::App* command = bench.add_subcommand(
      "trip-test",
      "Trip every interlock, one at a time, and print a sheet: limit, time in which the bench must be safe, "
      "alarm, action, what was seen. A simulated bench is given faults. On a bench of metal limits are "
      "lowered "
      "in slow motion, and a person is asked for the rest, or writes why a row is left out. Each row ends "
      "with "
      "torque off and brakes on. Exit code 1 where an interlock failed.\n"
      "Example: strainwave bench trip-test --schedule schedules/quick.yaml");
  auto options = std::make_shared<TripOptions>();
  command->add_option("BENCH", options->bench, "bench file (YAML); without it, the embedded simulated bench");
  command->add_option("--schedule", options->schedule,
                      "schedule (YAML) whose limits are tested; a bench of metal needs it");
  command
      ->add_option("--only", options->only,
                   "code of an interlock, as in the journal; may be given several times")
      ->allow_extra_args(false);
  command->add_option("--out", options->out, "new file that keeps the sheet as JSON");
  command->add_flag(
      "--yes", options->yes,
      "do not ask: somebody has seen to it that nobody is near the shafts; rows that need a hand are "
      "skipped");
  command->add_flag("--json", options->json, "the sheet as JSON on standard output");
  command->callback([options, &action] { action = [options] { return TripTest(*options); }; });
}

}  // namespace strainwave::bench
