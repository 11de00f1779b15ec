// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "bench/fleet/plan.h"

namespace strainwave::bench {

/// What sbatch is asked for beside the array itself; empty and 0: as the site has it.
struct SlurmRequest {
  std::string partition;
  std::string time_limit;
  std::string memory;
  std::size_t processors{};         // of each task
  std::size_t at_once{};            // tasks that may run
  std::vector<std::string> others;  // further options of sbatch, as they are
};

/// One task of the arrays that were submitted for a plan, as Slurm tells it.
struct SlurmTask {
  std::size_t shard{};
  std::string job;
  std::string state;  // PENDING, RUNNING, COMPLETED, NODE_FAIL, ...
  std::string reason;
  std::string node;
};

/// What Slurm knows of a plan.
struct SlurmView {
  std::vector<std::string> jobs;  // submitted so far
  std::vector<SlurmTask> tasks;   // the newest of each shard
  std::string trouble;            // why Slurm says nothing; empty where it answers
};

/// "0,2-5": numbers in growing order.
std::string ArrayText(std::span<const std::size_t> shards);

/// The script that Slurm runs for each task: it becomes `program fleet shard PLAN K`.
std::string JobScriptText(const PlanFolder& folder, const std::string& program);

/// Submits the shards as one job array, and keeps its number in the plan's folder.
/// @return the job's number.
/// @throws BenchError (exit code 3) where there is no Slurm, or with its words where it refuses.
std::string SubmitArray(const PlanFolder& folder, const FleetPlan& plan, const std::string& program,
                        std::span<const std::size_t> shards, const SlurmRequest& request);

/// The arrays that were submitted for a plan, oldest first. @throws BenchError for a damaged list.
std::vector<std::string> JobsOf(const PlanFolder& folder);

/// Asks squeue, and sacct for what squeue has forgotten. Nothing where no array was submitted.
std::optional<SlurmView> AskSlurm(const PlanFolder& folder);

/// Of lines "JOB|INDEX|STATE|REASON|NODE"; what is no number stands for many tasks or none, and is left out.
std::vector<SlurmTask> TasksOfSqueue(const std::string& lines);
/// Of lines "JOB_INDEX|STATE|NODE".
std::vector<SlurmTask> TasksOfSacct(const std::string& lines);

/// Whether a task of that state may still compute something by itself.
bool MayStillRun(const std::string& state);

}  // namespace strainwave::bench
