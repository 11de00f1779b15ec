// SPDX-License-Identifier: Apache-2.0
#include "bench/fleet/plan_files.h"

#include <algorithm>
#include <filesystem>
#include <set>
#include <system_error>

#include <fmt/format.h>

#include "bench/campaign/folder.h"
#include "bench/errors/bench_error.h"
#include "bench/prediction/measurement_paths.h"
#include "bench/sha256.h"
#include "daq/record_error.h"

namespace strainwave::bench {
namespace {

namespace fs = std::filesystem;

// Its file holds the blank test: the bench, not a gear.
constexpr int kPreparation = 0;

std::vector<std::string> CyclesOf(const CampaignFolder& campaign) {
  std::set<std::string> files;
  if (fs::is_directory(campaign.Cycles())) {
    for (const auto& entry : fs::directory_iterator(campaign.Cycles()))
      if (const fs::path& file = entry.path(); file.extension() == ".h5" &&
                                               !file.filename().string().starts_with('.') &&
                                               file != campaign.CycleFile(kPreparation))
        files.insert(file.string());
  }
  if (files.empty())
    Refuse(campaign.root, "has no complete cycle yet", "one at least; strainwave status shows how far it is");
  return {files.begin(), files.end()};
}

std::string SizeText(const PlannedFile& file) {
  return file.sha256.empty() ? "it is not there"
                             : fmt::format("its SHA-256 is {} ({} bytes)", file.sha256, file.bytes);
}

}  // namespace

PlannedFile SeenFiles::Look(const std::string& path) {
  std::error_code error;
  if (!fs::exists(path, error)) throw daq::RecordError(path, "there is no such file", "a record");
  if (!fs::is_regular_file(path)) throw daq::RecordError(path, "is no file", "a record");
  try {
    return {path, fs::file_size(path), Sha256OfFile(path)};
  } catch (const std::system_error& trouble) {
    throw daq::RecordError(path, fmt::format("cannot be read: {}", trouble.code().message()), "a record");
  }
}

const PlannedFile& SeenFiles::LookOnce(const std::string& path) {
  const auto known = seen_.find(path);
  return known != seen_.end() ? known->second : seen_.emplace(path, Look(path)).first->second;
}

std::vector<std::string> RecordPathsOf(const std::vector<std::string>& paths) {
  std::vector<std::string> files;
  for (const std::string& path : paths) {
    if (!fs::is_directory(path)) {
      files.push_back(path);
    } else if (const CampaignFolder campaign{path}; fs::exists(campaign.Journal())) {
      for (std::string& cycle : CyclesOf(campaign)) files.push_back(std::move(cycle));
    } else {
      for (const fs::path& file : SortPaths({path}).files) files.push_back(file.string());
    }
  }
  return files;
}

std::vector<std::string> PathsBeside(const std::string& record) {
  const fs::path whole = fs::absolute(record).lexically_normal();
  const CampaignFolder campaign{whole.parent_path().parent_path()};
  if (whole.parent_path() != campaign.Cycles() || !fs::exists(campaign.Journal())) return {};
  std::vector<std::string> paths{campaign.Journal().string()};
  // Rows of a journal that was not closed stand here.
  const std::string log = campaign.Journal().string() + "-wal";
  std::error_code none;
  if (const auto bytes = fs::file_size(log, none); !none && bytes > 0) paths.push_back(log);
  for (const FrozenFile& frozen : FrozenFiles(campaign))
    if (fs::exists(frozen.file)) paths.push_back(frozen.file.string());
  return paths;
}

void DemandUnchanged(const PlannedFile& file, const PlannedFile& now) {
  if (file == now) return;
  Refuse(file.path, fmt::format("has changed since the plan was made: {}", SizeText(now)),
         fmt::format("SHA-256 {}, {} bytes; a new plan for what it is now", file.sha256, file.bytes));
}

void DemandUnchanged(const PlannedInput& input, SeenFiles& files) {
  const auto now = [](const std::string& path, const auto& look) -> PlannedFile {
    std::error_code error;
    return std::filesystem::is_regular_file(path, error) ? look(path) : PlannedFile{path, 0, ""};
  };
  DemandUnchanged(input.file,
                  now(input.file.path, [&](const std::string& path) { return files.Look(path); }));
  for (const PlannedFile& file : input.beside)
    DemandUnchanged(file, now(file.path, [&](const std::string& path) { return files.LookOnce(path); }));
  for (const std::string& path : PathsBeside(input.file.path)) {
    if (std::ranges::find(input.beside, path, &PlannedFile::path) == input.beside.end())
      Refuse(path, "was not there when the plan was made",
             "the campaign as it was; a new plan for what it is now");
  }
}

}  // namespace strainwave::bench
