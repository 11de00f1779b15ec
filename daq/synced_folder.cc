// SPDX-License-Identifier: Apache-2.0
#include "daq/synced_folder.h"

#include <fcntl.h>
#include <unistd.h>

#include <vector>

#include "daq/data_file_error.h"
#include "daq/file_descriptor.h"

namespace strainwave::daq {

void SyncFolder(const std::filesystem::path& folder) {
  const FileDescriptor handle(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (!handle.is_open() || ::fsync(handle.get()) != 0) {
    throw DataFileError(LastError(), "cannot sync folder", folder.string());
  }
}

void SyncFolderOf(const std::filesystem::path& file) {
  SyncFolder(file.has_parent_path() ? file.parent_path() : std::filesystem::path("."));
}

bool MakeFolders(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> missing;
  for (auto path = std::filesystem::absolute(folder); !std::filesystem::exists(path);
       path = path.parent_path()) {
    missing.push_back(path);
  }
  std::filesystem::create_directories(folder);
  for (const auto& made : missing) {
    const auto parent = made.parent_path();
    if (::access(parent.c_str(), R_OK) == 0) SyncFolder(parent);
  }
  return !missing.empty();
}

}  // namespace strainwave::daq
