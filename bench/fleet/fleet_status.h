// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "bench/fleet/plan.h"
#include "bench/fleet/slurm.h"

namespace strainwave::bench {

/// A record without a result.
struct OpenInput {
  std::string path;
  std::size_t shard{};
  bool running{};     // its shard runs: on this machine, or as Slurm says
  std::string words;  // why it has none, where one try failed; empty: there was none
};

/// How far a plan is, counted by its results.
struct FleetStatus {
  std::string folder;
  std::string call;  // command and options
  std::size_t inputs{};
  std::size_t done{};
  std::size_t ended_badly{};  // of the done: a check failed, exit code 1
  std::size_t refused{};      // of the done: exit code 2
  std::size_t running{};
  std::size_t failed{};  // the last try came to nothing, and none runs
  std::size_t missing{};
  std::vector<OpenInput> open;  // in the plan's order
  std::optional<double> eta_s;  // while something runs and two results show the pace
  std::optional<SlurmView> slurm;
};

FleetStatus StatusOf(const PlanFolder& folder, const FleetPlan& plan);

/// Shards with a record that has no result, in growing order.
std::vector<std::size_t> OpenShards(const FleetStatus& status);
/// Of these, without those that Slurm is to run or runs.
std::vector<std::size_t> ShardsToSubmit(const FleetStatus& status);

nlohmann::ordered_json StatusJson(const FleetStatus& status);
std::string StatusText(const FleetStatus& status);

/// The first few records without a result, a line each, and how to go on.
std::string OpenText(const FleetStatus& status);

}  // namespace strainwave::bench
