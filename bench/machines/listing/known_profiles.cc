// SPDX-License-Identifier: Apache-2.0
#include <fstream>

#include "bench/configuration/read_drive_profile.h"
#include "bench/configuration/read_hid_profile.h"
#include "bench/machines/listing/find_devices.h"

namespace strainwave::bench {
namespace {

// Which kind of profile a file says it is, by the line that every one has.
bool Says(const std::filesystem::path& file, std::string_view mark) {
  std::ifstream stream(file);
  for (std::string line; std::getline(stream, line);) {
    if (line.starts_with(mark)) return true;
  }
  return false;
}

}  // namespace

void KnownProfiles::AddFolder(const std::filesystem::path& folder) {
  std::error_code none;
  for (const auto& entry : std::filesystem::directory_iterator(folder, none)) {
    const auto& file = entry.path();
    if (file.extension() != ".yaml") continue;
    try {
      if (Says(file, "drive_profile:")) drives[file] = ReadDriveProfile(file);
      if (Says(file, "hid_device:")) hid[file] = ReadHidProfile(file);
    } catch (const schedules::FileError& error) {
      troubles.emplace_back(error.what());
    }
  }
}

}  // namespace strainwave::bench
