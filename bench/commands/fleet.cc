// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include <fmt/core.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "bench/commands/commands.h"
#include "bench/commands/output.h"
#include "bench/commands/terminal.h"
#include "bench/errors/bench_error.h"
#include "bench/fleet/collect.h"
#include "bench/fleet/fleet_command.h"
#include "bench/fleet/fleet_status.h"
#include "bench/fleet/plan.h"
#include "bench/fleet/program.h"
#include "bench/fleet/shard.h"
#include "bench/fleet/slurm.h"
#include "daq/whole_file.h"

namespace strainwave::bench {
namespace {

struct SubmitOptions {
  std::vector<std::string> words;            // command and inputs
  std::vector<std::string> command_options;  // behind --
  std::string out;
  std::size_t shards{};
  bool local{};
  std::size_t jobs{};
  SlurmRequest slurm;
};

struct PlanOptions {
  std::string folder;
  std::size_t shard{};
  std::string out;
  std::string csv;
  bool json{};
};

PlanFolder FolderOf(const std::string& path) { return {std::filesystem::absolute(path).lexically_normal()}; }

PlanRequest RequestOf(const SubmitOptions& options) {
  return {options.words.front(),
          {options.words.begin() + 1, options.words.end()},
          options.command_options,
          options.shards};
}

FleetPlan PlanOf(const SubmitOptions& options, const PlanFolder& folder, const FleetProgram& program) {
  if (options.words.empty()) {
    if (!options.command_options.empty())
      Refuse(options.command_options.front(), "has no command", "COMMAND and records, or neither");
    FleetPlan plan = ReadPlan(folder);
    DemandProgram(folder, plan, program);
    return plan;
  }
  const PlanRequest request = RequestOf(options);
  const FleetPlan plan = MakePlan(request, program);
  if (!HasPlan(folder)) {
    CheckValues(FleetCommandNamed(request.command), request.options, program);
    WritePlan(folder, plan);
  }
  DemandSamePlan(folder, ReadPlan(folder), plan);
  return plan;
}

int CodeOf(const ShardEnd& end) {
  if (end.failed == 0) return static_cast<int>(ExitCode::kDone);
  return static_cast<int>(end.changed > 0 ? ExitCode::kWrongInput : ExitCode::kMachineFailed);
}

// Counted against the plan by what is there, not by what was done.
int TellEnd(const PlanFolder& folder, const FleetPlan& plan, const ShardEnd& end) {
  if (end.failed > 0) ToStderr("{}\n", end.first_words);
  const FleetStatus status = StatusOf(folder, plan);
  ToStdout("{}: {} of {} records have a result, {} of them computed now\n", status.folder, status.done,
           status.inputs, end.kept);
  return CodeOf(end);
}

int SubmitHere(const PlanFolder& folder, const FleetPlan& plan, const FleetProgram& program,
               std::size_t jobs) {
  EnterWorkingFolder(folder, plan);
  ShareLine line;
  const auto all = static_cast<double>(plan.inputs.size());
  const ShardEnd end = RunAllShards(folder, plan, program, jobs, [&](std::size_t done) {
    line.Show(fmt::format("{} of {} records", done, plan.inputs.size()), static_cast<double>(done) / all);
  });
  line.Clear();
  return TellEnd(folder, plan, end);
}

int SubmitToSlurm(const PlanFolder& folder, const FleetPlan& plan, const SlurmRequest& request) {
  const FleetStatus status = StatusOf(folder, plan);
  const std::vector<std::size_t> shards = ShardsToSubmit(status);
  if (shards.empty()) {
    ToStdout("{}: nothing to submit: {} of {} records have a result{}\n", status.folder, status.done,
             status.inputs, status.open.empty() ? "" : ", the shards of the others wait or run");
    return static_cast<int>(ExitCode::kDone);
  }
  const std::string job = SubmitArray(folder, plan, PathOfThisProgram(), shards, request);
  ToStdout("{}: job {}, {} of {} shards, {} of {} records have a result\n", status.folder, job, shards.size(),
           plan.shards, status.done, status.inputs);
  return static_cast<int>(ExitCode::kDone);
}

int Submit(const SubmitOptions& options) {
  const PlanFolder folder = FolderOf(options.out);
  const FleetProgram program = ThisProgram();
  const FleetPlan plan = PlanOf(options, folder, program);
  if (!options.local) return SubmitToSlurm(folder, plan, options.slurm);
  const std::size_t processors = std::max(1U, std::thread::hardware_concurrency());
  return SubmitHere(folder, plan, program, options.jobs > 0 ? options.jobs : processors);
}

int RunOneShard(const PlanOptions& options) {
  const PlanFolder folder = FolderOf(options.folder);
  const FleetPlan plan = ReadPlan(folder);
  const FleetProgram program = ThisProgram();
  EnterWorkingFolder(folder, plan);
  const ShardEnd end = RunShard(folder, plan, program, options.shard);
  if (end.failed > 0) ToStderr("{}\n", end.first_words);
  ToStdout("shard {}: {} records computed, {} were there, {} failed\n", options.shard, end.kept,
           end.were_there, end.failed);
  return CodeOf(end);
}

int ShowStatus(const PlanOptions& options) {
  const PlanFolder folder = FolderOf(options.folder);
  const FleetStatus status = StatusOf(folder, ReadPlan(folder));
  if (options.json) {
    ToStdout("{}\n", StatusJson(status).dump(2));
  } else {
    ToStdout("{}", StatusText(status));
    if (status.eta_s) ToStdout("to go    {}\n", DurationText(*status.eta_s));
  }
  return static_cast<int>(ExitCode::kDone);
}

int Collect(const PlanOptions& options) {
  const PlanFolder folder = FolderOf(options.folder);
  const FleetPlan plan = ReadPlan(folder);
  std::vector<std::filesystem::path> targets{options.out};
  if (!options.csv.empty()) targets.emplace_back(options.csv);
  DemandTargets(folder, plan, targets);
  const Collected all = CollectResults(folder, plan);
  daq::WriteFileAtomically(options.out, all.document.dump(1) + "\n");
  if (!options.csv.empty()) daq::WriteFileAtomically(options.csv, CsvOf(all.document));
  if (options.json) {
    ToStdout("{}\n", nlohmann::ordered_json{{"out", options.out},
                                            {"inputs", all.inputs},
                                            {"ended_badly", all.ended_badly},
                                            {"refused", all.refused}}
                         .dump(2));
  } else {
    ToStdout("{}: {} of {} records\n", options.out, all.inputs, all.inputs);
    if (all.ended_badly > 0) ToStdout("{} with a failed check\n", all.ended_badly);
    if (all.refused > 0) ToStdout("{} refused; why stands beside each\n", all.refused);
  }
  return static_cast<int>(all.ended_badly + all.refused > 0 ? ExitCode::kEndedBadly : ExitCode::kDone);
}

void AddSubmit(CLI::App& fleet, Action& action) {
  CLI::App* command = fleet.add_subcommand(
      "submit",
      "Make a plan of a command over many records, and submit it as a job array of Slurm, or compute it "
      "here. "
      "Where the plan is there already, what has no result yet is submitted again.\n"
      "Example: strainwave fleet submit recompute loop.csv --out plan --local -- --method backbone");
  auto options = std::make_shared<SubmitOptions>();
  command->add_option("COMMAND", options->words,
                      "recompute, features or diagnose, then records, folders of records and campaigns (each "
                      "cycle is a record); behind -- options of the command. Nothing: as the plan has it");
  command->add_option("--out", options->out, "folder of the plan and its results, seen by all machines")
      ->required();
  command->add_option("--shards", options->shards, "parts of the plan (default: one a record, at most 64)")
      ->check(CLI::Range(1, 1'000'000));
  CLI::Option* local =
      command->add_flag("--local", options->local, "compute here, without Slurm: the same bits");
  command->add_option("--jobs", options->jobs, "shards at a time, here (default: one a processor)")
      ->check(CLI::Range(1, 4096))
      ->needs(local);
  command->add_option("--partition", options->slurm.partition, "of the cluster")->excludes(local);
  command->add_option("--time", options->slurm.time_limit, "limit of a task, as sbatch takes it: 1:00:00")
      ->excludes(local);
  command->add_option("--memory", options->slurm.memory, "of a task, as sbatch takes it: 2G")
      ->excludes(local);
  command->add_option("--processors", options->slurm.processors, "of a task")
      ->check(CLI::Range(1, 4096))
      ->excludes(local);
  command->add_option("--at-once", options->slurm.at_once, "tasks that may run at a time")
      ->check(CLI::Range(1, 1'000'000))
      ->excludes(local);
  command
      ->add_option("--sbatch", options->slurm.others, "a further option of sbatch, as --sbatch=--account=lab")
      ->excludes(local)
      ->allow_extra_args(false);
  command->callback([options, &fleet, &action] {
    options->command_options = fleet.remaining();
    action = [options] { return Submit(*options); };
  });
}

// Only `submit` takes what stands behind --.
void SetAction(CLI::App& command, const CLI::App& fleet, Action& action, const Action& does) {
  command.callback([&fleet, &action, does] {
    if (const auto others = fleet.remaining(); !others.empty()) throw CLI::ExtrasError(others);
    action = does;
  });
}

CLI::App* AddPlanCommand(CLI::App& fleet, PlanOptions& options, const char* name, const char* help) {
  CLI::App* command = fleet.add_subcommand(name, help);
  command->add_option("PLAN", options.folder, "folder of the plan")->required();
  return command;
}

}  // namespace

void AddFleet(CLI::App& app, Action& action) {
  CLI::App* fleet = app.add_subcommand(
      "fleet",
      "Recompute, features and diagnose over many records on many machines, as job arrays of Slurm: the same "
      "bits as on one, whatever dies in between.\n"
      "Example: strainwave fleet submit recompute loop.csv --out plan --local");
  fleet->require_subcommand(1);
  AddSubmit(*fleet, action);
  auto options = std::make_shared<PlanOptions>();
  CLI::App* status = AddPlanCommand(*fleet, *options, "status",
                                    "How far a plan is, counted by its results, and what Slurm says of it.\n"
                                    "Example: strainwave fleet status plan");
  status->add_flag("--json", options->json, "JSON on standard output");
  SetAction(*status, *fleet, action, [options] { return ShowStatus(*options); });
  CLI::App* collect = AddPlanCommand(
      *fleet, *options, "collect",
      "All results of a plan in one document, in the plan's order. Exit code 1 where a result is missing "
      "(then nothing is written), a check of a record failed, or a record is refused.\n"
      "Example: strainwave fleet collect plan --out results.json --csv results.csv");
  collect->add_option("--out", options->out, "JSON file to write; one of that name is replaced")->required();
  collect->add_option("--csv", options->csv, "the same as a table: one row a report");
  collect->add_flag("--json", options->json, "what was written, as JSON on standard output");
  SetAction(*collect, *fleet, action, [options] { return Collect(*options); });
  CLI::App* shard = AddPlanCommand(
      *fleet, *options, "shard",
      "Compute one shard of a plan, what is there left out: what a task of the job array runs, and any other "
      "scheduler may.\n"
      "Example: strainwave fleet shard plan 0");
  shard->add_option("K", options->shard, "number of the shard, from 0")->required();
  SetAction(*shard, *fleet, action, [options] { return RunOneShard(*options); });
  // What stands behind -- comes here. Its commands, which are there already, allow none.
  fleet->allow_extras();
}

}  // namespace strainwave::bench
