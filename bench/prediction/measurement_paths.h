// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

namespace strainwave::bench {

/// What measurements are read from.
struct MeasurementPaths {
  std::vector<std::filesystem::path> campaigns;
  std::vector<std::filesystem::path> files;  // of records
};

/// Sorts what a user named: campaign folders; files; of any other folder the .csv, .h5 and .hdf5 files in it
/// and below, by name.
/// @throws BenchError for a folder without either.
MeasurementPaths SortPaths(const std::vector<std::filesystem::path>& paths);

}  // namespace strainwave::bench
