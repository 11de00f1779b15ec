// SPDX-License-Identifier: Apache-2.0
#include "bench/fleet/fleet_status.h"

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <map>
#include <set>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "bench/fleet/kept_results.h"
#include "bench/fleet/shard.h"

namespace strainwave::bench {
namespace {

constexpr std::size_t kMostShown = 5;

std::set<std::size_t> RunningShards(const PlanFolder& folder, const FleetPlan& plan,
                                    const std::optional<SlurmView>& slurm) {
  std::set<std::size_t> running;
  for (std::size_t shard = 0; shard < plan.shards; ++shard)
    if (ShardMark::IsHeld(folder, shard)) running.insert(shard);
  if (!slurm) return running;
  for (const SlurmTask& task : slurm->tasks)
    if (MayStillRun(task.state) && task.state != "PENDING") running.insert(task.shard);
  return running;
}

// From the pace between the first and the last of the results that the shards under way have kept, so that a
// pause between two submissions does not count.
std::optional<double> TimeToGo_s(const PlanFolder& folder, const FleetPlan& plan, const FleetStatus& status,
                                 const std::set<std::size_t>& running) {
  if (running.empty()) return std::nullopt;
  std::filesystem::file_time_type first = std::filesystem::file_time_type::max();
  std::filesystem::file_time_type last = std::filesystem::file_time_type::min();
  std::filesystem::file_time_type begun = first;
  for (const std::size_t shard : running) {
    std::error_code error;
    const auto time = std::filesystem::last_write_time(folder.Shards() / fmt::format("{}", shard), error);
    if (!error) begun = std::min(begun, time);
  }
  std::size_t count = 0;
  for (const PlannedInput& input : plan.inputs) {
    std::error_code error;
    const auto time = std::filesystem::last_write_time(folder.Results() / (input.key + ".json"), error);
    if (error || time < begun) continue;
    first = std::min(first, time);
    last = std::max(last, time);
    ++count;
  }
  if (count < 2 || last <= first) return std::nullopt;
  const double each_s = std::chrono::duration<double>(last - first).count() / static_cast<double>(count - 1);
  return each_s * static_cast<double>(status.inputs - status.done);
}

std::map<std::string, std::size_t> StatesOf(const SlurmView& slurm) {
  std::map<std::string, std::size_t> states;
  for (const SlurmTask& task : slurm.tasks) ++states[task.state];
  return states;
}

std::string SlurmText(const SlurmView& slurm) {
  std::string text = fmt::format("slurm    job {}", fmt::join(slurm.jobs, ", "));
  if (!slurm.trouble.empty()) return text + ": " + slurm.trouble + "\n";
  for (const auto& [state, count] : StatesOf(slurm)) text += fmt::format(", {} {}", count, state);
  text += slurm.tasks.empty() ? ": ended, and forgotten by Slurm\n" : "\n";
  for (const SlurmTask& task : slurm.tasks) {
    // One that is held waits until somebody lets it go (scontrol release).
    const bool is_held = task.reason.find("eld") != std::string::npos;
    if (is_held || (!MayStillRun(task.state) && task.state != "COMPLETED"))
      text +=
          fmt::format("         task {} {} {}\n", task.shard, task.state, is_held ? task.reason : task.node);
  }
  return text;
}

}  // namespace

FleetStatus StatusOf(const PlanFolder& folder, const FleetPlan& plan) {
  FleetStatus status;
  status.folder = folder.root.string();
  status.call =
      fmt::format("{}{}{}", plan.command, plan.options.empty() ? "" : " ", fmt::join(plan.options, " "));
  status.inputs = plan.inputs.size();
  status.slurm = AskSlurm(folder);
  const std::set<std::size_t> running = RunningShards(folder, plan, status.slurm);
  for (const PlannedInput& input : plan.inputs) {
    if (const auto result = ReadResult(folder, input)) {
      ++status.done;
      if (result->exit_code == 1) ++status.ended_badly;
      if (result->exit_code == 2) ++status.refused;
      continue;
    }
    OpenInput open{input.file.path, input.shard, running.contains(input.shard),
                   ReadFailure(folder, input).value_or("")};
    ++(open.running ? status.running : open.words.empty() ? status.missing : status.failed);
    status.open.push_back(std::move(open));
  }
  status.eta_s = TimeToGo_s(folder, plan, status, running);
  return status;
}

std::vector<std::size_t> OpenShards(const FleetStatus& status) {
  std::set<std::size_t> shards;
  for (const OpenInput& input : status.open) shards.insert(input.shard);
  return {shards.begin(), shards.end()};
}

std::vector<std::size_t> ShardsToSubmit(const FleetStatus& status) {
  std::vector<std::size_t> shards = OpenShards(status);
  if (!status.slurm) return shards;
  std::erase_if(shards, [&](std::size_t shard) {
    return std::ranges::any_of(status.slurm->tasks, [&](const SlurmTask& task) {
      return task.shard == shard && MayStillRun(task.state);
    });
  });
  return shards;
}

nlohmann::ordered_json StatusJson(const FleetStatus& status) {
  nlohmann::ordered_json open = nlohmann::ordered_json::array();
  for (const OpenInput& input : status.open) {
    open.push_back({{"path", input.path},
                    {"shard", input.shard},
                    {"state", input.running         ? "running"
                              : input.words.empty() ? "missing"
                                                    : "failed"},
                    {"words", input.words}});
  }
  nlohmann::ordered_json json{{"plan", status.folder},
                              {"call", status.call},
                              {"inputs", status.inputs},
                              {"done", status.done},
                              {"ended_badly", status.ended_badly},
                              {"refused", status.refused},
                              {"running", status.running},
                              {"failed", status.failed},
                              {"missing", status.missing},
                              {"eta_s", status.eta_s ? nlohmann::ordered_json(*status.eta_s) : nullptr},
                              {"open", std::move(open)}};
  if (!status.slurm) return json;
  nlohmann::ordered_json tasks = nlohmann::ordered_json::array();
  for (const SlurmTask& task : status.slurm->tasks) {
    tasks.push_back({{"shard", task.shard},
                     {"job", task.job},
                     {"state", task.state},
                     {"reason", task.reason},
                     {"node", task.node}});
  }
  json["slurm"] = {
      {"jobs", status.slurm->jobs}, {"trouble", status.slurm->trouble}, {"tasks", std::move(tasks)}};
  return json;
}

std::string OpenText(const FleetStatus& status) {
  std::string text;
  const std::size_t shown = std::min(status.open.size(), kMostShown);
  for (std::size_t i = 0; i < shown; ++i) {
    const OpenInput& input = status.open[i];
    text += fmt::format("  {} (shard {}): {}\n", input.path, input.shard,
                        !input.words.empty() ? input.words
                        : input.running      ? "under way"
                                             : "no result yet");
  }
  if (shown < status.open.size()) text += fmt::format("  and {} more\n", status.open.size() - shown);
  return text;
}

std::string StatusText(const FleetStatus& status) {
  std::string text = fmt::format("{}: {} of {} records\n", status.folder, status.call, status.inputs);
  text += fmt::format("done     {}", status.done);
  if (status.ended_badly > 0) text += fmt::format(", {} of them with a failed check", status.ended_badly);
  if (status.refused > 0) text += fmt::format(", {} of them refused as records", status.refused);
  text +=
      fmt::format("\nrunning  {}\nfailed   {}\nmissing  {}\n", status.running, status.failed, status.missing);
  if (status.slurm) text += SlurmText(*status.slurm);
  return text + OpenText(status);
}

}  // namespace strainwave::bench
