// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "bench/fleet/program.h"

namespace strainwave::bench {

/// A file as it was when the plan was made.
struct PlannedFile {
  std::string path;  // as it was named; of one not absolute: from the plan's working folder
  std::uint64_t bytes{};
  std::string sha256;

  bool operator==(const PlannedFile&) const = default;
};

/// A record of which one result is to be had.
struct PlannedInput {
  PlannedFile file;
  std::vector<PlannedFile> beside;  // what the result rests on besides: the campaign that the record lies in
  std::size_t shard{};
  std::string key;  // names the result: SHA-256 of program, command, options and all these files
};

/// What is to be computed, by which program; it never changes. The same call makes the same bytes again.
struct FleetPlan {
  FleetProgram program;
  std::string command;
  std::vector<std::string> options;
  std::vector<PlannedFile> option_files;
  std::string working_folder;
  std::size_t shards{};
  std::vector<PlannedInput> inputs;  // in the user's order
};

/// Where the files of a plan are.
struct PlanFolder {
  std::filesystem::path root;

  std::filesystem::path Plan() const { return root / "plan.json"; }
  std::filesystem::path Results() const { return root / "results"; }
  std::filesystem::path Failures() const { return root / "failures"; }
  std::filesystem::path Shards() const { return root / "shards"; }  // a lock of each that runs here
  std::filesystem::path Logs() const { return root / "logs"; }
  std::filesystem::path JobScript() const { return root / "job.sh"; }
  std::filesystem::path Jobs() const { return root / "jobs.json"; }
};

/// What a user asks for.
struct PlanRequest {
  std::string command;
  std::vector<std::string> paths;  // records; folders of these; campaigns, whose cycles are meant
  std::vector<std::string> options;
  std::size_t shards{};  // 0: one an input, at most 64
};

/// Reads every input once. Shards are dealt out by rank of the keys, so that neither the order of the inputs
/// nor their names' decides, and no two differ in number by more than one.
/// @throws BenchError, RecordError for what is no input or no option of the command.
FleetPlan MakePlan(const PlanRequest& request, const FleetProgram& program);

/// Writes a plan that is not there yet; where another program has meanwhile, that one stays.
/// @throws DataFileError; BenchError for a folder that holds anything else.
void WritePlan(const PlanFolder& folder, const FleetPlan& plan);

bool HasPlan(const PlanFolder& folder);

/// @throws BenchError where there is none, it has changed since it was written, or is of another format.
FleetPlan ReadPlan(const PlanFolder& folder);

/// @throws BenchError where the plan was made for another program: a result holds for one alone.
void DemandProgram(const PlanFolder& folder, const FleetPlan& plan, const FleetProgram& program);

/// @throws BenchError where the plan there is of something else.
void DemandSamePlan(const PlanFolder& folder, const FleetPlan& there, const FleetPlan& asked);

}  // namespace strainwave::bench
