// SPDX-License-Identifier: Apache-2.0
#include "bench/fleet/slurm.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <chrono>
#include <filesystem>
#include <map>
#include <string_view>
#include <system_error>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "bench/errors/bench_error.h"
#include "bench/plots/child_program.h"
#include "bench/prediction/sealed_json.h"
#include "daq/whole_file.h"

namespace strainwave::bench {
namespace {

using JobsJson = nlohmann::ordered_json;

constexpr const char* kJobs = "jobs";
// A controller that is away lets its clients wait for it.
constexpr std::chrono::seconds kSlurmAnswersWithin{60};

std::vector<std::string> Fields(std::string_view line) {
  std::vector<std::string> fields;
  for (std::size_t begin = 0; begin <= line.size();) {
    const std::size_t end = std::min(line.find('|', begin), line.size());
    fields.emplace_back(line.substr(begin, end - begin));
    begin = end + 1;
  }
  return fields;
}

std::vector<std::vector<std::string>> Rows(std::string_view text) {
  std::vector<std::vector<std::string>> rows;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    if (end > begin) rows.push_back(Fields(text.substr(begin, end - begin)));
    begin = end + 1;
  }
  return rows;
}

std::optional<std::size_t> IndexOf(std::string_view text) {
  std::size_t number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return number;
}

// In a shell's single quotes.
std::string InQuotes(const std::string& text) {
  std::string quoted = "'";
  for (const char c : text) quoted += c == '\'' ? "'\\''" : std::string(1, c);
  return quoted + "'";
}

// Slurm replaces what begins with % in the names of log files.
std::string AsLogName(const std::filesystem::path& path) {
  std::string name;
  for (const char c : path.string()) name += c == '%' ? "%%" : std::string(1, c);
  return name;
}

void KeepJob(const PlanFolder& folder, const std::string& job) {
  std::vector<std::string> jobs = JobsOf(folder);
  jobs.push_back(job);
  JobsJson json{{kJobs, jobs}};
  Seal(json);
  daq::WriteFileAtomically(folder.Jobs(), json.dump(1) + "\n");
}

std::string FirstLine(const std::string& text) { return text.substr(0, text.find('\n')); }

// The newest word of each shard; jobs are in the order of their submission.
void Take(const std::vector<SlurmTask>& tasks, std::map<std::size_t, SlurmTask>& newest) {
  for (const SlurmTask& task : tasks) newest.insert_or_assign(task.shard, task);
}

}  // namespace

std::string ArrayText(std::span<const std::size_t> shards) {
  std::vector<std::string> ranges;
  for (std::size_t i = 0; i < shards.size();) {
    std::size_t last = i;
    while (last + 1 < shards.size() && shards[last + 1] == shards[last] + 1) ++last;
    ranges.push_back(i == last ? fmt::format("{}", shards[i])
                               : fmt::format("{}-{}", shards[i], shards[last]));
    i = last + 1;
  }
  return fmt::format("{}", fmt::join(ranges, ","));
}

std::string JobScriptText(const PlanFolder& folder, const std::string& program) {
  return fmt::format(
      "#!/bin/sh\n"
      "# One task of the array computes one shard; what is there already is left alone.\n"
      "exec {} fleet shard {} \"$SLURM_ARRAY_TASK_ID\"\n",
      InQuotes(program), InQuotes(folder.root.string()));
}

std::string SubmitArray(const PlanFolder& folder, const FleetPlan& plan, const std::string& program,
                        std::span<const std::size_t> shards, const SlurmRequest& request) {
  daq::WriteFileAtomically(folder.JobScript(), JobScriptText(folder, program));
  std::string array = "--array=" + ArrayText(shards);
  if (request.at_once > 0) array += fmt::format("%{}", request.at_once);
  // A log that is begun anew when a task is requeued would lose why.
  std::vector<std::string> words{"sbatch",
                                 "--parsable",
                                 array,
                                 "--requeue",
                                 "--open-mode=append",
                                 "--job-name=strainwave-" + plan.command,
                                 "--chdir=" + plan.working_folder,
                                 "--output=" + AsLogName(folder.Logs()) + "/%a.txt"};
  if (!request.partition.empty()) words.push_back("--partition=" + request.partition);
  if (!request.time_limit.empty()) words.push_back("--time=" + request.time_limit);
  if (!request.memory.empty()) words.push_back("--mem=" + request.memory);
  if (request.processors > 0) words.push_back(fmt::format("--cpus-per-task={}", request.processors));
  words.insert(words.end(), request.others.begin(), request.others.end());
  words.push_back(folder.JobScript().string());
  const ChildEnd end = RunChild(std::move(words), "", kSlurmAnswersWithin, ChildOutputs::kApart);
  if (end.error == ENOENT) {
    throw BenchError(
        ExitCode::kMachineFailed,
        "error: there is no sbatch on this machine (expected Slurm's client, Debian's slurm-client; or "
        "--local, which computes the same here)");
  }
  if (end.error != 0 || end.late || end.signal != 0 || end.exit_code != 0) {
    throw BenchError(
        ExitCode::kMachineFailed,
        fmt::format(
            "error: sbatch submits nothing: {} (expected a job; or --local, which computes the same here)",
            end.late         ? "Slurm does not answer"
            : end.error != 0 ? std::generic_category().message(end.error)
                             : FirstLine(end.words)));
  }
  // "JOB", or "JOB;CLUSTER" where there are several.
  const std::string job = end.said.substr(0, end.said.find_first_of(";\n"));
  KeepJob(folder, job);
  return job;
}

std::vector<std::string> JobsOf(const PlanFolder& folder) {
  if (!std::filesystem::exists(folder.Jobs())) return {};
  try {
    const JobsJson json = JobsJson::parse(ReadBounded(folder.Jobs(), "the jobs of a plan"));
    RequireSeal(folder.Jobs(), json);
    return json.at(kJobs);
  } catch (const JobsJson::exception&) {
    Refuse(folder.Jobs(), "is no list of jobs", "what strainwave fleet submit writes");
  }
}

std::vector<SlurmTask> TasksOfSqueue(const std::string& lines) {
  std::vector<SlurmTask> tasks;
  for (const auto& fields : Rows(lines)) {
    if (fields.size() < 5) continue;
    if (const auto shard = IndexOf(fields[1]))
      tasks.push_back({*shard, fields[0], fields[2], fields[3], fields[4]});
  }
  return tasks;
}

std::vector<SlurmTask> TasksOfSacct(const std::string& lines) {
  std::vector<SlurmTask> tasks;
  for (const auto& fields : Rows(lines)) {
    if (fields.size() < 3) continue;
    const std::size_t dash = fields[0].find('_');
    if (dash == std::string::npos) continue;
    // "CANCELLED by 1000"
    if (const auto shard = IndexOf(std::string_view(fields[0]).substr(dash + 1)))
      tasks.push_back(
          {*shard, fields[0].substr(0, dash), fields[1].substr(0, fields[1].find(' ')), "", fields[2]});
  }
  return tasks;
}

bool MayStillRun(const std::string& state) {
  constexpr std::array<std::string_view, 8> kUnderWay{"PENDING",   "RUNNING",  "CONFIGURING", "COMPLETING",
                                                      "SUSPENDED", "REQUEUED", "REQUEUE_FED", "STAGE_OUT"};
  return std::ranges::find(kUnderWay, std::string_view(state)) != kUnderWay.end();
}

std::optional<SlurmView> AskSlurm(const PlanFolder& folder) {
  SlurmView view{JobsOf(folder), {}, ""};
  if (view.jobs.empty()) return std::nullopt;
  std::map<std::size_t, SlurmTask> newest;
  for (const std::string& job : view.jobs) {
    const ChildEnd queue = RunChild(
        {"squeue", "--noheader", "--array", "--states=all", "--jobs=" + job, "--format=%F|%K|%T|%r|%N"}, "",
        kSlurmAnswersWithin, ChildOutputs::kApart);
    if (queue.error != 0 || queue.late) {
      view.trouble = queue.late ? "Slurm does not answer" : "there is no squeue on this machine";
      break;
    }
    if (queue.exit_code == 0) {
      Take(TasksOfSqueue(queue.said), newest);
      continue;
    }
    // The controller forgets jobs that have ended; whoever keeps accounts does not.
    if (queue.words.find("Invalid job id") == std::string::npos) {
      view.trouble = FirstLine(queue.words);
      break;
    }
    const ChildEnd accounts = RunChild({"sacct", "--noheader", "--parsable2", "--allocations",
                                        "--jobs=" + job, "--format=JobID,State,NodeList"},
                                       "", kSlurmAnswersWithin, ChildOutputs::kApart);
    if (accounts.error == 0 && accounts.exit_code == 0) Take(TasksOfSacct(accounts.said), newest);
  }
  for (auto& [shard, task] : newest) view.tasks.push_back(std::move(task));
  return view;
}

}  // namespace strainwave::bench
