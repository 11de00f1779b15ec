// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

namespace strainwave::bench {

/// A folder of files by what they hold: `ab/abcdef…`, the SHA-256 in hexadecimal. The same bytes are kept
/// once, whichever bench or campaign they come from; a file is there whole or not at all, and never changed.
class RecordStore {
 public:
  /// Makes the folder where it is missing. @throws BenchError (exit code 2) where it cannot be one;
  ///   std::system_error, daq::DataFileError.
  explicit RecordStore(std::filesystem::path folder);

  /// Copies a file into the store, unless its bytes are there.
  /// @return false where the file's bytes are not those that `sha256` stands for: nothing is kept then.
  /// @throws std::system_error, daq::DataFileError.
  bool Keep(const std::filesystem::path& file, const std::string& sha256) const;
  /// Copies it out of the store; the bytes are looked at. @return false where it is not there, or damaged.
  bool Fetch(const std::string& sha256, const std::filesystem::path& file) const;

 private:
  std::filesystem::path PathOf(const std::string& sha256) const;

  std::filesystem::path folder_;
};

}  // namespace strainwave::bench
