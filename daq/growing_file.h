// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <system_error>
#include <vector>

#include "daq/cycle_file.h"
#include "daq/file_descriptor.h"

/// Records that grow for hours, kept as they grow, in case the program dies (`FORMAT.md`, "Growing records").
namespace strainwave::daq {

/// Writes blocks of new rows at the end of a file; nothing that is in it is written again.
class GrowingFile {
 public:
  /// A new file; one of that name is replaced. @throws DataFileError.
  GrowingFile(const std::filesystem::path& path, Attributes attributes);

  /// Adds the rows that have come since the last call, and the metadata as they are now; a record of one row
  /// counts as a summary and is written anew. On the disk when it returns.
  /// @param records  the whole records so far: the same groups with the same columns, in any call.
  /// @throws DataFileError; after a sync that failed, of which the kernel speaks once, each time.
  void Append(std::span<const NamedRecord> records);

 private:
  void DemandSynced() const;

  std::filesystem::path path_;
  FileDescriptor file_;
  Attributes attributes_;
  std::map<std::string, std::size_t> rows_;  // on the disk, by group
  std::uint64_t blocks_{};
  std::error_code failed_sync_;
};

struct GrownFile {
  Attributes attributes;
  std::vector<NamedRecord> records;
  std::uint64_t lost_bytes{};  // at the end, of a block that was cut
};

/// The records as the last whole block has left them; without any, none.
/// @throws RecordError if the file cannot be read, or a block is damaged that is not the last.
GrownFile ReadGrowingFile(const std::filesystem::path& path);

}  // namespace strainwave::daq
