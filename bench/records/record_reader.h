// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "daq/import/record_map.h"
#include "daq/record.h"

namespace strainwave::bench {

/// Reads the files that a user names: records as docs/contract.md#record-files has them, and, by a mapping
/// file, what instruments and other programs wrote.
class RecordReader {
 public:
  RecordReader() = default;
  /// @param map_file  empty: none. @throws MapFileError.
  explicit RecordReader(const std::filesystem::path& map_file);

  /// @throws RecordError as `ReadRecords` and `MapRecord`. A file in a format of others that names its
  /// columns
  ///   as records do needs no map; for any other the message says how to write one.
  std::vector<daq::Record> Read(const std::filesystem::path& path) const;

 private:
  std::optional<daq::RecordMap> map_;
};

/// What a file holds, in lines for people (`PreviewOf`). Read in a process of its own.
/// @throws RecordError.
std::vector<std::string> PreviewOfFile(const std::filesystem::path& path);

}  // namespace strainwave::bench
