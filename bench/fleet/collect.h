// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "bench/fleet/plan.h"

namespace strainwave::bench {

/// All results of a plan, in its order.
struct Collected {
  nlohmann::ordered_json document;
  std::size_t inputs{};
  std::size_t ended_badly{};  // a check failed
  std::size_t refused{};
};

/// Before anything is written. @throws BenchError for one that is no file, stands for another target, or on
/// whose bytes the plan rests: its own files, records and what lies beside these.
void DemandTargets(const PlanFolder& folder, const FleetPlan& plan,
                   const std::vector<std::filesystem::path>& targets);

/// Where, in how many shards and in what order they were computed leaves no trace in it. Sums are taken here,
/// in the order of the plan.
/// @throws BenchError (exit code 1) with the first few names where a result is missing.
Collected CollectResults(const PlanFolder& folder, const FleetPlan& plan);

/// One row a report: its record and every value at its top, features by their names, causes in one cell.
std::string CsvOf(const nlohmann::ordered_json& document);

}  // namespace strainwave::bench
