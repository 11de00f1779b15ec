// SPDX-License-Identifier: Apache-2.0
#include "bench/campaign/kept_files.h"

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

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

void Register(const CampaignFolder& folder, Journal& journal, const fs::path& file) {
  journal.AddFile(file.lexically_relative(folder.root).generic_string(), fs::file_size(file),
                  Sha256OfFile(file));
}

}  // namespace

void RegisterFilesOfCycle(const CampaignFolder& folder, Journal& journal, int cycle) {
  const fs::path picture = folder.CycleFile(cycle).replace_extension(".jpg");
  if (fs::exists(picture)) Register(folder, journal, picture);
  const std::string own = fmt::format("{:06d}-", cycle);
  for (const fs::path& file : FilesIn(folder.Streams())) {
    if (file.filename().string().starts_with(own)) Register(folder, journal, file);
  }
}

void RegisterFiles(const CampaignFolder& folder, Journal& journal) {
  const auto registered = journal.Files();
  Transaction transaction(journal.database());
  for (const fs::path& place :
       {folder.Cycles(), folder.Streams(), folder.Faults(), folder.BusLogs(), folder.Pictures()}) {
    for (const fs::path& file : FilesIn(place)) {
      if (place == folder.Cycles() && file.extension() == kRecords) continue;
      const auto known = registered.find(file.lexically_relative(folder.root).generic_string());
      const bool same = known != registered.end() && known->second.bytes == fs::file_size(file) &&
                        (place != folder.Pictures() || known->second.sha256 == Sha256OfFile(file));
      if (!same) Register(folder, journal, file);
    }
  }
  transaction.Commit();
}

}  // namespace strainwave::bench
