// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

namespace strainwave::bench {

/// Where a user wants files written, looked at before anything is computed. @throws BenchError (exit code 2).
/// A folder that is there, or can be made: nothing on the way to it is a file.
void DemandOutputFolder(const std::filesystem::path& folder);
/// Of a file that is written together with its folder: that one.
void DemandFolderOf(const std::filesystem::path& file);
/// A file that is there, or can be made in a folder that is.
void DemandOutputFile(const std::filesystem::path& file);

}  // namespace strainwave::bench
