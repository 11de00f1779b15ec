// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "daq/import/record_map.h"
#include "schedules/reader/findings.h"

namespace strainwave::bench {

/// A mapping file that cannot be used.
class MapFileError : public schedules::FileError {
 public:
  using FileError::FileError;
};

/// Reads a mapping file (`map: 1`; docs/contract.md#files-of-others).
/// @throws MapFileError with every error of the file, each with line and column.
daq::RecordMap ReadMapFile(const std::filesystem::path& path);
/// The same for a text, which messages call `file_name`.
daq::RecordMap ParseMapFile(const std::string& text, std::string_view file_name);

}  // namespace strainwave::bench
