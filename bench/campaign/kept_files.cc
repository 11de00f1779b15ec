// SPDX-License-Identifier: Apache-2.0
#include "bench/campaign/kept_files.h"

#include <algorithm>
#include <filesystem>
#include <utility>

#include <fmt/core.h>

#include "bench/sha256.h"

namespace strainwave::bench {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kRecords = ".h5";

// In the order of their names, so that the same campaign has the same chain.
std::vector<fs::path> FilesIn(const fs::path& folder) {
  std::vector<fs::path> files;
  if (!fs::is_directory(folder)) return files;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.is_regular_file()) files.push_back(entry.path());
  }
  std::ranges::sort(files);
  return files;
}

std::string PathIn(const CampaignFolder& folder, const fs::path& file) {
  return file.lexically_relative(folder.root).generic_string();
}

KeptFile Kept(const CampaignFolder& folder, const fs::path& file) {
  return {PathIn(folder, file), {fs::file_size(file), Sha256OfFile(file)}};
}

}  // namespace

std::vector<KeptFile> FilesOfCycle(const CampaignFolder& folder, int cycle) {
  std::vector<KeptFile> kept;
  const fs::path picture = folder.CycleFile(cycle).replace_extension(".jpg");
  if (fs::exists(picture)) kept.push_back(Kept(folder, picture));
  const std::string own = fmt::format("{:06d}-", cycle);
  for (const fs::path& file : FilesIn(folder.Streams())) {
    if (file.filename().string().starts_with(own)) kept.push_back(Kept(folder, file));
  }
  return kept;
}

void RegisterFiles(const CampaignFolder& folder, Journal& journal) {
  const auto registered = journal.Files();
  std::vector<KeptFile> changed;
  for (const fs::path& place :
       {folder.Cycles(), folder.Streams(), folder.Faults(), folder.BusLogs(), folder.Pictures()}) {
    for (const fs::path& file : FilesIn(place)) {
      if (place == folder.Cycles() && file.extension() == kRecords) continue;
      const auto known = registered.find(PathIn(folder, file));
      const bool may_be_same = known != registered.end() && known->second.bytes == fs::file_size(file);
      if (may_be_same && place != folder.Pictures()) continue;
      KeptFile kept = Kept(folder, file);
      if (!may_be_same || known->second.sha256 != kept.digest.sha256) changed.push_back(std::move(kept));
    }
  }
  Transaction transaction(journal.database());
  for (const KeptFile& kept : changed) journal.AddFile(kept.path, kept.digest);
  transaction.Commit();
}

}  // namespace strainwave::bench
