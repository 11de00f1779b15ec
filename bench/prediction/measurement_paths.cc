// SPDX-License-Identifier: Apache-2.0
#include "bench/prediction/measurement_paths.h"

#include <algorithm>
#include <set>
#include <string_view>

#include "bench/campaign/folder.h"
#include "bench/errors/bench_error.h"

namespace strainwave::bench {
namespace {

namespace fs = std::filesystem;

bool IsRecordFile(const fs::path& path) {
  constexpr std::string_view kExtensions[] = {".csv", ".h5", ".hdf5"};
  return std::ranges::find(kExtensions, path.extension().string()) != std::end(kExtensions);
}

}  // namespace

MeasurementPaths SortPaths(const std::vector<fs::path>& paths) {
  MeasurementPaths sorted;
  for (const fs::path& path : paths) {
    if (!fs::is_directory(path)) {
      if (!fs::exists(path)) Refuse(path, "is not a campaign", "a folder with campaign.db");
      sorted.files.push_back(path);
      continue;
    }
    if (fs::exists(CampaignFolder{path}.Journal())) {
      sorted.campaigns.push_back(path);
      continue;
    }
    std::set<fs::path> inside;
    for (const auto& entry : fs::recursive_directory_iterator(path)) {
      if (entry.is_regular_file() && IsRecordFile(entry.path())) inside.insert(entry.path());
    }
    if (inside.empty()) Refuse(path, "is not a campaign", "a folder with campaign.db, or with record files");
    sorted.files.insert(sorted.files.end(), inside.begin(), inside.end());
  }
  return sorted;
}

}  // namespace strainwave::bench
