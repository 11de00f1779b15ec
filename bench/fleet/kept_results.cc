// SPDX-License-Identifier: Apache-2.0
#include "bench/fleet/kept_results.h"

#include <unistd.h>

#include <array>
#include <filesystem>
#include <system_error>

#include <fmt/format.h>

#include "bench/errors/bench_error.h"
#include "bench/prediction/sealed_json.h"
#include "daq/synced_folder.h"
#include "daq/whole_file.h"

namespace strainwave::bench {
namespace {

namespace fs = std::filesystem;
using ResultJson = nlohmann::ordered_json;

constexpr int kResultFormat = 1;

fs::path FileIn(const fs::path& folder, const PlannedInput& input) { return folder / (input.key + ".json"); }

// Two writers of the same file, on whatever machines, have names of their own until it is whole.
void WriteByName(const fs::path& file, const std::string& text) {
  std::array<char, 256> host{};
  ::gethostname(host.data(), host.size() - 1);
  fs::path own = file;
  own += fmt::format(".{}.{}.{}", host.data(), ::getpid(), ::gettid());
  daq::WriteFileAtomically(own, text);
  fs::rename(own, file);
  daq::SyncFolderOf(file);
}

std::optional<ResultJson> ReadSealed(const fs::path& file, const PlannedInput& input) {
  if (!fs::exists(file)) return std::nullopt;
  try {
    ResultJson json = ResultJson::parse(ReadBounded(file, "a result"));
    RequireSeal(file, json);
    if (json.at("fleet_result") != kResultFormat || json.at("key") != input.key) return std::nullopt;
    return json;
  } catch (const ResultJson::exception&) {
    return std::nullopt;
  } catch (const BenchError&) {
    return std::nullopt;
  }
}

// What a program said may hold anything.
std::string AsText(const std::string& words) {
  return ResultJson::parse(ResultJson(words).dump(-1, ' ', false, ResultJson::error_handler_t::replace));
}

ResultJson HeadOf(const PlannedInput& input) {
  return {{"fleet_result", kResultFormat}, {"key", input.key}, {"path", input.file.path}};
}

}  // namespace

std::optional<FleetResult> ReadResult(const PlanFolder& folder, const PlannedInput& input) {
  const auto json = ReadSealed(FileIn(folder.Results(), input), input);
  if (!json) return std::nullopt;
  return FleetResult{json->at("exit_code"), json->at("report"), json->at("words")};
}

void KeepResult(const PlanFolder& folder, const PlannedInput& input, const FleetResult& result) {
  ResultJson json = HeadOf(input);
  json["exit_code"] = result.exit_code;
  json["report"] = result.report;
  json["words"] = AsText(result.words);
  Seal(json);
  WriteByName(FileIn(folder.Results(), input), json.dump() + "\n");
  std::error_code none_there;
  fs::remove(FileIn(folder.Failures(), input), none_there);
}

void KeepFailure(const PlanFolder& folder, const PlannedInput& input, const std::string& words) {
  ResultJson json = HeadOf(input);
  json["words"] = AsText(words);
  Seal(json);
  WriteByName(FileIn(folder.Failures(), input), json.dump() + "\n");
}

std::optional<std::string> ReadFailure(const PlanFolder& folder, const PlannedInput& input) {
  const auto json = ReadSealed(FileIn(folder.Failures(), input), input);
  return json ? std::optional<std::string>(json->at("words")) : std::nullopt;
}

}  // namespace strainwave::bench
