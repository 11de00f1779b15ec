// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string_view>

namespace strainwave::daq {

/// The bytes of a file without a copy of them in memory. A file that another program shortens meanwhile ends
/// the process (SIGBUS): only for work in a process of its own.
class MappedFile {
 public:
  /// @throws RecordError if it cannot be opened or is no plain file.
  explicit MappedFile(const std::filesystem::path& path);
  MappedFile(const MappedFile&) = delete;
  MappedFile& operator=(const MappedFile&) = delete;
  ~MappedFile();

  std::string_view text() const { return {data_, size_}; }

 private:
  const char* data_{};
  std::size_t size_{};
};

}  // namespace strainwave::daq
