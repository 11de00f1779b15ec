// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "bench/campaign/database.h"
#include "protocols/sparkplug.h"

namespace strainwave::bench {

/// What waits for a broker, in a SQLite file: a monitor that is killed, and a power cut, lose none of it.
/// Beside the entries it keeps what a monitor goes on counting from: windows, dropped entries, connections.
/// Every change is on the disk when the call returns. For one monitor at a time, and not for several threads.
class OutboxStore {
 public:
  struct Entry {
    std::int64_t id{};
    std::vector<protocols::SparkplugMetric> metrics;
  };
  /// A change: entries that come and go, together or not at all.
  struct Change {
    std::vector<std::string> added;  // each as EncodeMetrics has it, in order
    std::int64_t last_window{};      // of the last one added
    std::vector<std::int64_t> removed{};
    std::uint64_t dropped{};  // of all time
  };

  /// Opens or makes the file. @throws BenchError if another monitor has it, or it is something else;
  /// DatabaseError.
  explicit OutboxStore(const std::filesystem::path& file);

  /// Oldest first. @throws BenchError for an entry that cannot be read.
  std::vector<Entry> Entries() const;
  std::uint64_t dropped() const { return static_cast<std::uint64_t>(Kept("dropped")); }
  /// Number of the last window that was put in, 0 before the first.
  std::int64_t last_window() const { return Kept("last_window"); }
  /// Birth–death number of the next connection.
  int next_birth() const { return static_cast<int>(Kept("next_birth")); }
  const std::filesystem::path& file() const { return database_.file(); }

  /// @return the ids of what was added. @throws DatabaseError, with nothing changed.
  std::vector<std::int64_t> Make(const Change& change);
  /// @throws DatabaseError.
  void KeepNextBirth(int number);

 private:
  std::int64_t Kept(std::string_view name) const;
  void Keep(std::string_view name, std::int64_t value);

  Database database_;
};

}  // namespace strainwave::bench
