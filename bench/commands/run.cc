// SPDX-License-Identifier: Apache-2.0
#include <unistd.h>

#include <algorithm>
#include <memory>
#include <optional>

#include <fmt/core.h>
#include <CLI/CLI.hpp>

#include "analysis/units.h"
#include "bench/campaign/calibrations.h"
#include "bench/campaign/campaign.h"
#include "bench/campaign/campaign_runner.h"
#include "bench/campaign/disk_room.h"
#include "bench/campaign/kept_files.h"
#include "bench/campaign/on_all_processors.h"
#include "bench/campaign/run_begun.h"
#include "bench/campaign/salvage_note.h"
#include "bench/campaign/unattended.h"
#include "bench/commands/commands.h"
#include "bench/commands/output.h"
#include "bench/commands/pace.h"
#include "bench/commands/page_beside.h"
#include "bench/commands/person.h"
#include "bench/commands/results_table.h"
#include "bench/commands/service_manager.h"
#include "bench/commands/terminal.h"
#include "bench/configuration/sensors_of.h"
#include "bench/errors/bench_error.h"
#include "bench/errors/output_path.h"
#include "bench/machines/make_machine.h"
#include "bench/safety/interlocks.h"
#include "bench/spare_memory.h"
#include "bench/utc.h"
#include "daq/cycle_file.h"
#include "daq/software.h"

namespace strainwave::bench {
namespace {

// A cycle's longest fit takes a quarter of the time of all.
constexpr std::size_t kAnalysisThreads = 4;

struct RunOptions {
  std::string schedule;
  std::string bench;
  std::string out;
  std::string pace{"max"};
  std::string truth;
  bool resume{};
  bool extend{};
  bool accept_pause{};
  bool accept_expired{};
  bool by_service{};
  bool unattended{};
  bool json{};
  bool serves{};
  PageOptions page;
};

// The truth of a sweep is that at its own standstills.
SimulatedTest TestOf(const schedules::Schedule& schedule, double pace, const std::string& truth) {
  SimulatedTest test{schedule.specimen.ratio, RadFromDeg(1.0), 360, pace, truth};
  for (const auto& phase : schedule.phases) {
    const auto* sweep = std::get_if<schedules::TransmissionErrorSweep>(&phase.parameters);
    if (sweep == nullptr) continue;
    test.sweep_step_rad = sweep->step_rad;
    test.sweep_steps = sweep->steps;
    break;
  }
  return test;
}

ExitCode CodeOf(const CampaignEnd& end) {
  switch (end.kind) {
    case CampaignEnd::Kind::kCompleted:
      return ExitCode::kDone;
    case CampaignEnd::Kind::kStopCriterion:
      return ExitCode::kEndedBadly;
    case CampaignEnd::Kind::kFault:
      return end.device_failed ? ExitCode::kMachineFailed : ExitCode::kEndedBadly;
    case CampaignEnd::Kind::kInterrupted:
      return ExitCode::kInterrupted;
  }
  return ExitCode::kMachineFailed;
}

// What is not known of the bench is told and noted; what speaks against it must be mended first.
void CheckFindings(const BenchMachine& machine, Journal& journal) {
  std::string refused;
  for (const BenchMachine::Finding& finding : machine.Findings()) {
    if (finding.refuses) {
      refused += fmt::format("{}error: {}", refused.empty() ? "" : "\n", finding.words);
      continue;
    }
    ToStderr("warning: {}\n", finding.words);
    journal.AddEvent({journal.LatestTime_s(), UtcNow(), journal.LastCompleteCycle() + 1, "", "warning",
                      "commissioning", finding.words});
  }
  if (!refused.empty()) throw BenchError(ExitCode::kMachineFailed, refused);
}

// A disk that is full ends the campaign safely, and days too late.
void WarnOfLittleRoom(const CampaignFolder& folder, const schedules::Schedule& schedule, int complete) {
  const auto room = DiskRoomOf(folder, PlannedCycle_bytes(schedule), complete, schedule.cycles);
  if (!room || !IsLittle(*room)) return;
  ToStderr(
      "{}: warning: {} are free, and the raw data of the cycles to come may take {} (expected more; what is "
      "compressed takes less)\n",
      folder.root.string(), BytesText(room->free_bytes), BytesText(room->needed_bytes));
}

// A limit of the schedule that nothing on this bench measures.
void NoteUnwatchedLimits(const BenchDescription& bench, Journal& journal) {
  for (const InterlockRow& row : Interlocks::Table(SensorsOf(bench))) {
    if (row.unwatched.empty() || !row.limit.starts_with("limits.")) continue;
    journal.AddEvent({journal.LatestTime_s(), UtcNow(), journal.LastCompleteCycle() + 1, "", "warning",
                      "interlocks", fmt::format("{} watches nothing: {}", row.limit, row.unwatched)});
  }
}

// Of a run that the watchdog has stopped, or the machine that was shut down, none: it counts as cut.
void NoteEnd(Journal& journal, const CampaignEnd& end) {
  const auto note = [&](const char* severity, const char* code, const char* text) {
    journal.AddEvent(
        {journal.LatestTime_s(), UtcNow(), journal.LastCompleteCycle() + 1, "", severity, code, text});
  };
  const bool stopped = end.kind == CampaignEnd::Kind::kInterrupted;
  if (stopped && WatchdogHasStopped()) {
    note("warning", "watchdog", "the service manager's watchdog has stopped the run, for it had not gone on");
  } else if (stopped && end.reason.cause == StopCause::kShutdownRequested && MachineHasStopped()) {
    note("info", "machine_shutdown", "the machine was shut down, and no person has stopped the run");
  } else {
    NoteRunEnded(journal, end.text);
  }
}

// What has ended the program is mended by a person, and not by going on; on a disk that takes nothing more it
// cannot be kept.
void NoteError(Journal& journal, const std::exception& ended) {
  try {
    NoteRunEnded(journal, ended.what());
  } catch (const DatabaseError& error) {
    ToStderr("warning: {}\n", error.what());
  }
}

// How a person goes on with it.
std::string Resumption(const RunOptions& options) {
  return options.schedule.empty()
             ? fmt::format("strainwave run --out {} --resume", options.out)
             : fmt::format("strainwave run {} --out {} --resume", options.schedule, options.out);
}

void CheckFolder(const RunOptions& options, const CampaignFolder& folder) {
  const bool there = std::filesystem::exists(folder.Journal());
  if (!there && options.resume) {
    throw BenchError(
        ExitCode::kWrongInput,
        fmt::format("{}: error: there is no campaign to resume (expected a folder with campaign.db; "
                    "leave --resume away to start one)",
                    folder.root.string()));
  }
  if (there && !options.resume) {
    throw BenchError(ExitCode::kWrongInput,
                     fmt::format("{}: error: the folder holds a campaign already (expected a new folder, or "
                                 "--resume to go on with it)",
                                 folder.root.string()));
  }
  if (options.schedule.empty() && !options.resume) {
    throw BenchError(
        ExitCode::kWrongInput,
        "error: no schedule is given (expected strainwave run SCHEDULE --out DIR; a campaign that "
        "goes on with --resume has its own)");
  }
}

void CheckInputs(const RunOptions& options, const CampaignFolder& folder, const CampaignInputs& inputs) {
  const std::string schedule = options.schedule.empty() ? folder.Schedule().string() : options.schedule;
  for (const auto& finding : WarningsOf(inputs).items()) {
    ToStderr("{}\n", schedules::FormatFinding(schedule, finding));
  }
  if (!options.accept_expired) {
    RefuseToStart(CalibrationTroubles(CalibrationsOf(inputs.bench), {}, Today()), inputs.bench);
  }
}

// The service that packaging/strainwave@.service describes has its campaigns there.
int LeaveToService(const RunOptions& options, const CampaignFolder& folder, Journal& journal) {
  const RunOrder order{Now(), PersonsName(), options.accept_pause};
  KeepRunOrder(journal, order);
  journal.SetProperty(kRunPace, options.pace);
  journal.AddEvent({journal.LatestTime_s(), UtcText(order.given.utc_ms), journal.LastCompleteCycle() + 1, "",
                    "info", "acknowledged",
                    fmt::format("{} has ordered --by-service, and with it that shafts may move", order.by)});
  const auto path = std::filesystem::weakly_canonical(folder.root);
  ToStderr("{}: a service may run it, if it begins within ten minutes: {}\n", folder.root.string(),
           path.parent_path() == "/var/lib/strainwave"
               ? fmt::format("systemctl start strainwave@{}", path.filename().string())
               : fmt::format("strainwave run --out {} --resume --unattended", path.string()));
  return static_cast<int>(ExitCode::kDone);
}

// Where the campaign goes on; nothing where all is done.
std::optional<ResumePoint> Resume(const RunOptions& options, const CampaignFolder& folder,
                                  const CampaignInputs& inputs, Journal& journal, ResumeOrder& order) {
  const bool complete = journal.LastCompleteCycle() >= inputs.schedule.cycles;
  if (options.unattended && !complete)
    order = DemandUnattendedStart(folder, journal, inputs.schedule.resume, Now());
  return PrepareResume(folder, inputs, journal, order);
}

// What is kept of a run that begins.
void NoteBegin(const RunOptions& options, Journal& journal, double begins_s, int restart) {
  Transaction transaction(journal.database());
  journal.AddEvent({begins_s, UtcNow(), journal.LastCompleteCycle() + 1, "", "info", "software",
                    std::string(daq::Software())});
  journal.SetProperty(kRunPace, options.pace);
  const Moment now = Now();
  journal.SetProperty(kRunBegun, TextOf({now.utc_ms, begins_s, ::getpid(), now.since_boot_ms, now.boot}));
  NoteRunBegins(journal, restart);
  transaction.Commit();
}

CampaignEnd RunOnBench(const RunOptions& options, const CampaignInputs& inputs, HeldFolder held,
                       Journal& journal, const std::optional<ResumePoint>& resume, int restart) {
  const auto machine =
      MakeMachine(inputs.bench, TestOf(inputs.schedule, ParsePace(options.pace), options.truth), Ask);
  CheckFindings(*machine, journal);
  NoteUnwatchedLimits(inputs.bench, journal);
  if (!options.accept_expired) {
    RefuseToStart(CalibrationTroubles(CalibrationsOf(inputs.bench), machine->Calibrations(), Today()),
                  inputs.bench);
  }
  WaitForPeople(*machine);
  TerminalProgress terminal;
  ServiceManager manager;
  ServiceProgress progress(terminal, manager);
  CampaignRunner runner(std::move(held), inputs.schedule, inputs.bench, *machine, journal, Requested(),
                        progress);
  NoteBegin(options, journal, resume ? resume->time_s : 0.0, restart);
  manager.Ready();
  try {
    CampaignEnd end = runner.Run(resume.value_or(ResumePoint{}));
    journal.SetProperty("overruns_of_the_last_run", std::to_string(machine->Devices().clock.Overruns()));
    NoteEnd(journal, end);
    return end;
  } catch (const std::exception& error) {
    // The runner has made the bench safe before the exception left it; what is stored stays whole.
    ToStderr(
        "stopped: torque is off, brakes are on, the campaign is whole; when the cause below is "
        "mended, go on "
        "with: {}\n",
        Resumption(options));
    NoteError(journal, error);
    throw;
  }
}

void TellOfEnd(const RunOptions& options, const CampaignEnd& end) {
  if (end.kind == CampaignEnd::Kind::kFault) {
    if (!end.black_box.empty()) ToStderr("the channels before and after it: {}\n", end.black_box.string());
    ToStderr("stopped: torque is off, brakes are on; when the cause is mended, go on with: {}\n",
             Resumption(options));
  }
  if (end.kind == CampaignEnd::Kind::kInterrupted) {
    ToStderr("stopped safely; go on with: {}\n", Resumption(options));
  }
}

int Run(RunOptions options) {
  ListenForRequests();
  { const SpareMemory enough; }  // for what comes next
  daq::SetUpHdf5();
  const ProcessorLimit few(kAnalysisThreads);
  const SpareMemory spare;
  const LiveOutput output([] { return Requested() != StopRequest::kNone; });
  ParsePace(options.pace);
  if (options.serves) CheckPageOptions(options.page);
  const CampaignFolder folder{options.out};
  CampaignInputs inputs;
  if (!options.schedule.empty()) {
    inputs = ReadInputs(options.schedule, options.bench.empty()
                                              ? std::nullopt
                                              : std::optional<std::filesystem::path>(options.bench));
  }
  DemandOutputFolder(folder.root);
  CheckFolder(options, folder);
  if (!options.schedule.empty()) CheckInputs(options, folder, inputs);
  const CampaignLock lock(folder);
  Journal journal =
      options.resume ? OpenCampaign(folder, Database::Mode::kReadWrite) : CreateCampaign(folder, inputs);
  HeldFolder held(folder);
  if (options.resume) {
    if (SalvageNoteOf(journal)) {
      Refuse(folder.root, "was salvaged from another campaign, and is for analysis",
             "the folder in which the campaign ran");
    }
    for (const std::string& warning : WarningsAbout(folder, journal)) ToStderr("{}\n", warning);
    if (options.schedule.empty()) {
      inputs = ReadFrozenInputs(folder, journal);
      inputs.bench = BenchToResume(folder, journal);
      CheckInputs(options, folder, inputs);
    }
    if (options.extend) ToStderr("{}\n", ExtendCampaign(folder, inputs, journal));
  }
  if (options.by_service) return LeaveToService(options, folder, journal);
  std::optional<ResumePoint> resume;
  ResumeOrder order{PersonsName(), options.accept_pause, 0};
  if (options.resume) {
    resume = Resume(options, folder, inputs, journal, order);
    if (!resume) {
      ToStderr("{}: all cycles are complete; nothing to resume\n", folder.root.string());
      return PrintCampaign(folder, journal, options.json);
    }
    if (!options.schedule.empty()) inputs.bench = BenchToResume(folder, journal);
    if (options.unattended) options.pace = journal.Property(kRunPace).value_or(options.pace);
  }
  if (options.serves) ServeBeside(folder, options.page);
  WarnOfLittleRoom(folder, inputs.schedule, std::max(0, journal.LastCompleteCycle()));
  const CampaignEnd end = RunOnBench(options, inputs, std::move(held), journal, resume, order.restart);
  TellOfEnd(options, end);
  PrintCampaign(folder, journal, options.json);
  RegisterFiles(folder, journal);
  for (const ChannelTrouble& bad : journal.ChannelTroubles()) {
    ToStderr("BAD CHANNEL {} at the end, since {}: {}\n", bad.channel, bad.since_utc, bad.reason);
  }
  return static_cast<int>(CodeOf(end));
}

}  // namespace

void AddRun(CLI::App& app, Action& action) {
  CLI::App* command =
      app.add_subcommand("run",
                         "Run a campaign from a schedule file.\n"
                         "Ctrl-C is the quick stop: torque off, brakes on, everything kept, exit code 130. "
                         "Softer ends: strainwave stop.\n"
                         "Example: strainwave run schedules/quick.yaml --out campaigns/first");
  auto options = std::make_shared<RunOptions>();
  command->add_option("SCHEDULE", options->schedule,
                      "schedule file (YAML); with --resume, the campaign's own where it is left away");
  command->add_option("--bench", options->bench,
                      "bench file (YAML); without it, the embedded simulated bench");
  command->add_option("--out", options->out, "the campaign's folder")->required();
  CLI::Option* const resume =
      command->add_flag("--resume", options->resume, "go on with the campaign in the folder");
  command
      ->add_flag(
          "--extend", options->extend,
          "go on to the schedule's number of cycles, which is higher than the campaign's; nothing else "
          "of the schedule may have changed")
      ->needs(resume);
  command->add_flag("--accept-pause", options->accept_pause,
                    "resume even after a pause longer than the schedule allows");
  command->add_flag("--accept-expired", options->accept_expired,
                    "run with calibrations that do not hold today; every record says so");
  CLI::Option* const by_service =
      command->add_flag("--by-service", options->by_service,
                        "make the folder, or open it with --resume, and leave the run to a service that is "
                        "started within ten minutes: systemctl start strainwave@NAME");
  command
      ->add_flag("--unattended", options->unattended,
                 "for that service: run what --by-service has ordered, or what was cut, as often in a row as "
                 "resume.unattended of the schedule says; never after a fault or a stop")
      ->needs(resume)
      ->excludes(by_service);
  command->add_option("--pace", options->pace, "of a simulated bench: max, real, or N times real time")
      ->capture_default_str();
  command->add_option("--truth", options->truth,
                      "of a simulated bench: file for the truth that only it knows (CSV)");
  command->add_flag("--json", options->json, "results as JSON on standard output");
  CLI::Option* const serve = command->add_flag(
      "--serve", options->serves,
      "the live page beside it, as strainwave serve DIR: a process of its own, which stays");
  AddPageOptions(*command, options->page, serve);
  command->callback([options, &action] { action = [options] { return Run(*options); }; });
}

}  // namespace strainwave::bench
