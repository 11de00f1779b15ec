// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

namespace strainwave::daq {

/// Waits until the names in a folder are on the disk: what was made, renamed and removed there. The sync of a
/// file does not do that for its own name (fsync(2), Linux man-pages).
/// @throws DataFileError.
void SyncFolder(const std::filesystem::path& folder);

/// Of the folder that a file lies in.
void SyncFolderOf(const std::filesystem::path& file);

/// Makes a folder, and those that it lies in, where they are missing; with their names they are on the disk
/// then. One that may not be read cannot be synced; a name in it is left to the file system.
/// @return whether there was any to make.
/// @throws std::filesystem::filesystem_error, DataFileError.
bool MakeFolders(const std::filesystem::path& folder);

}  // namespace strainwave::daq
