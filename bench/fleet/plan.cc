// SPDX-License-Identifier: Apache-2.0
#include "bench/fleet/plan.h"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <numeric>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "bench/errors/bench_error.h"
#include "bench/errors/output_path.h"
#include "bench/escaped.h"
#include "bench/fleet/fleet_command.h"
#include "bench/fleet/plan_files.h"
#include "bench/prediction/sealed_json.h"
#include "bench/sha256.h"
#include "daq/synced_folder.h"
#include "daq/whole_file.h"

namespace strainwave::bench {
namespace {

using PlanJson = nlohmann::ordered_json;

constexpr int kPlanFormat = 1;
constexpr const char* kFormatKey = "fleet_plan";
constexpr std::size_t kMostShardsUnasked = 64;

PlanJson PlannedFileJson(const PlannedFile& file) {
  return {{"path", file.path}, {"bytes", file.bytes}, {"sha256", file.sha256}};
}

PlanJson PlannedFilesJson(const std::vector<PlannedFile>& files) {
  PlanJson list = PlanJson::array();
  for (const PlannedFile& file : files) list.push_back(PlannedFileJson(file));
  return list;
}

PlannedFile FileOf(const PlanJson& json) {
  return {json.at("path").get<std::string>(), json.at("bytes").get<std::uint64_t>(),
          json.at("sha256").get<std::string>()};
}

std::vector<PlannedFile> FilesOf(const PlanJson& list) {
  std::vector<PlannedFile> files;
  for (const PlanJson& json : list) files.push_back(FileOf(json));
  return files;
}

std::vector<std::string> Hashes(const std::vector<PlannedFile>& files) {
  std::vector<std::string> hashes;
  for (const PlannedFile& file : files) hashes.push_back(file.sha256);
  return hashes;
}

// The path belongs to it, since reports name the record.
std::string KeyOf(const FleetPlan& plan, const PlannedInput& input) {
  const PlanJson all{kPlanFormat,     plan.program.software, plan.program.sha256,
                     plan.command,    plan.options,          Hashes(plan.option_files),
                     input.file.path, input.file.sha256,     Hashes(input.beside)};
  return Sha256(all.dump());
}

void DealOut(FleetPlan& plan) {
  std::vector<std::size_t> order(plan.inputs.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, {}, [&](std::size_t i) { return plan.inputs[i].key; });
  for (std::size_t rank = 0; rank < order.size(); ++rank) plan.inputs[order[rank]].shard = rank % plan.shards;
}

PlanJson FleetPlanJson(const FleetPlan& plan) {
  PlanJson inputs = PlanJson::array();
  for (const PlannedInput& input : plan.inputs) {
    PlanJson json = PlannedFileJson(input.file);
    json["shard"] = input.shard;
    json["key"] = input.key;
    if (!input.beside.empty()) json["beside"] = PlannedFilesJson(input.beside);
    inputs.push_back(std::move(json));
  }
  PlanJson json{{kFormatKey, kPlanFormat},
                {"software", plan.program.software},
                {"program_sha256", plan.program.sha256},
                {"command", plan.command},
                {"options", plan.options},
                {"option_files", PlannedFilesJson(plan.option_files)},
                {"working_folder", plan.working_folder},
                {"shards", plan.shards},
                {"inputs", std::move(inputs)}};
  Seal(json);
  return json;
}

FleetPlan PlanOf(const PlanJson& json) {
  FleetPlan plan{.program = {"", json.at("software"), json.at("program_sha256")},
                 .command = json.at("command"),
                 .options = json.at("options"),
                 .option_files = FilesOf(json.at("option_files")),
                 .working_folder = json.at("working_folder"),
                 .shards = json.at("shards"),
                 .inputs = {}};
  for (const PlanJson& one : json.at("inputs")) {
    plan.inputs.push_back({FileOf(one),
                           one.contains("beside") ? FilesOf(one["beside"]) : std::vector<PlannedFile>{},
                           one.at("shard"), one.at("key")});
  }
  return plan;
}

std::string NameOf(const FleetProgram& program) {
  return fmt::format("{}, SHA-256 {}", program.software, program.sha256);
}

std::string CallOf(const FleetPlan& plan) {
  return fmt::format("{}{}{} of {} records", plan.command, plan.options.empty() ? "" : " ",
                     fmt::join(plan.options, " "), plan.inputs.size());
}

}  // namespace

FleetPlan MakePlan(const PlanRequest& request, const FleetProgram& program) {
  const FleetCommand& command = FleetCommandNamed(request.command);
  FleetPlan plan{.program = program,
                 .command = request.command,
                 .options = request.options,
                 .option_files = {},
                 .working_folder = std::filesystem::current_path().string(),
                 .shards = request.shards,
                 .inputs = {}};
  SeenFiles files;
  for (const std::string& path : FilesOfOptions(command, request.options))
    plan.option_files.push_back(files.LookOnce(path));
  for (const std::string& path : RecordPathsOf(request.paths)) {
    if (const std::string shown = Escaped(path); shown != path)
      Refuse(shown, "has a name that is not text of one line", "a name in UTF-8 without control characters");
    PlannedInput input{files.Look(path), {}, 0, ""};
    for (const std::string& other : PathsBeside(path)) input.beside.push_back(files.LookOnce(other));
    input.key = KeyOf(plan, input);
    plan.inputs.push_back(std::move(input));
  }
  if (plan.inputs.empty())
    throw BenchError(ExitCode::kWrongInput, "error: no record (expected one at least)");
  plan.shards = std::min(plan.shards == 0 ? kMostShardsUnasked : plan.shards, plan.inputs.size());
  DealOut(plan);
  return plan;
}

void WritePlan(const PlanFolder& folder, const FleetPlan& plan) {
  const std::array own{folder.Results(), folder.Failures(), folder.Shards(), folder.Logs()};
  if (std::filesystem::exists(folder.root)) {
    if (!std::filesystem::is_directory(folder.root))
      Refuse(folder.root, "is no folder", "a folder of the plan");
    for (const auto& entry : std::filesystem::directory_iterator(folder.root)) {
      const bool is_own = std::ranges::find(own, entry.path()) != own.end() ||
                          entry.path().filename().string().starts_with(".plan.json");
      if (!is_own && entry.path() != folder.Plan())
        Refuse(folder.root, "holds other files", "a folder for the plan alone, empty or not there yet");
    }
  }
  DemandOutputFolder(folder.root);
  for (const auto& inside : own) daq::MakeFolders(inside);
  // A link fails where there is a plan by now: of two that are submitted at once, one is the plan.
  const std::filesystem::path made = folder.root / fmt::format(".plan.json.{}", ::getpid());
  daq::WriteFileAtomically(made, FleetPlanJson(plan).dump(1) + "\n");
  std::error_code failure;
  std::filesystem::create_hard_link(made, folder.Plan(), failure);
  std::filesystem::remove(made);
  if (failure && failure != std::errc::file_exists)
    throw std::filesystem::filesystem_error("cannot make the plan", folder.Plan(), failure);
  daq::SyncFolderOf(folder.Plan());
}

bool HasPlan(const PlanFolder& folder) { return std::filesystem::exists(folder.Plan()); }

FleetPlan ReadPlan(const PlanFolder& folder) {
  const std::string expected = "a plan, which strainwave fleet submit makes";
  const std::string text = ReadBounded(folder.Plan(), expected);
  try {
    const PlanJson json = PlanJson::parse(text);
    if (const auto format = json.find(kFormatKey); format != json.end() && *format != kPlanFormat) {
      Refuse(folder.Plan(), fmt::format("it has format {}", format->dump()),
             fmt::format("format {}", kPlanFormat));
    }
    RequireSeal(folder.Plan(), json);
    return PlanOf(json);
  } catch (const PlanJson::exception&) {
    Refuse(folder.Plan(), "is no plan", expected);
  }
}

void DemandProgram(const PlanFolder& folder, const FleetPlan& plan, const FleetProgram& program) {
  if (plan.program.software == program.software && plan.program.sha256 == program.sha256) return;
  Refuse(folder.Plan(), fmt::format("the plan was made for another program than this {}", NameOf(program)),
         NameOf(plan.program) + "; or a new plan");
}

void DemandSamePlan(const PlanFolder& folder, const FleetPlan& there, const FleetPlan& asked) {
  DemandProgram(folder, there, asked.program);
  for (std::size_t i = 0; i < std::min(there.inputs.size(), asked.inputs.size()); ++i) {
    if (there.inputs[i].file.path == asked.inputs[i].file.path)
      DemandUnchanged(there.inputs[i].file, asked.inputs[i].file);
  }
  if (FleetPlanJson(there) == FleetPlanJson(asked)) return;
  Refuse(
      folder.Plan(), fmt::format("is there already, of something else: {}", CallOf(there)),
      "a new folder; or the same records, options, shards and working folder as then, which strainwave fleet "
      "submit without them takes from the plan");
}

}  // namespace strainwave::bench
