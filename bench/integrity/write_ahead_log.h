// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace strainwave::bench {

/// SQLite's write-ahead log beside a database, as far as its own checksums hold (sqlite.org/fileformat2.html,
/// "The Write-Ahead Log").
struct LogReport {
  std::uint64_t frames{};  // that count: whole, of the present log, with the commit that ends them
  std::string damage;      // in words; empty: none
};

/// SQLite drops a frame that does not match and all after it without a word: what it takes for the end of the
/// log is held here against the frames that follow. A log cut by a power failure looks like a damaged one.
/// @returns no frames for a log that is empty or not there. @throws daq::RecordError.
LogReport CheckLog(const std::filesystem::path& log);

}  // namespace strainwave::bench
