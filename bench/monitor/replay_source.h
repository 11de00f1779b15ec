// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <vector>

#include "bench/roles/vibration_source.h"
#include "daq/record.h"

namespace strainwave::bench {

struct ReplaySettings {
  std::vector<std::filesystem::path> files;  // in order
  /// The records of a file, each a measurement of its own: replay_records.h.
  std::function<std::vector<daq::Record>(const std::filesystem::path& file)> read;
  int rounds{1};     // through all files
  double every_s{};  // from the beginning of one record to that of the next; 0: each follows the last at once
  double pace{1.0};  // times real time; infinity: as fast as it can
  double ratio{80.0};       // of the gear: turns of the input to one of the output
  std::int64_t start_ns{};  // time of the first sample, since 1970, UTC
};

/// Records of files as a stream in blocks. Each record is a measurement of its own; what cannot be read is a
/// chunk with trouble, and the next file follows.
class ReplaySource final : public VibrationSource {
 public:
  explicit ReplaySource(ReplaySettings settings);

  Got Next(std::chrono::milliseconds patience, VibrationChunk& chunk) override;
  /// At a finite pace the clock's; as fast as it can, that of the last chunk's end.
  std::int64_t NowNanoseconds() const override;

 private:
  struct Playing {
    VibrationChunk whole;
    std::size_t at{};
  };
  bool LoadNext();
  void LoadFile(const std::filesystem::path& path);
  void AddRecord(const daq::Record& record);
  void TakeBlock(VibrationChunk& chunk);
  bool DueWithin(std::int64_t time_ns, std::chrono::milliseconds patience) const;

  ReplaySettings settings_;
  std::chrono::steady_clock::time_point began_;
  std::size_t next_file_{};
  int round_{};
  std::vector<VibrationChunk> loaded_;  // records of one file, whole, the next one last
  std::optional<Playing> playing_;
  std::int64_t next_start_ns_;
  std::atomic<std::int64_t> last_ns_;
};

/// The files that a user's paths stand for: files themselves, and the cycles of campaign folders in order.
/// @throws BenchError for a folder without cycles.
std::vector<std::filesystem::path> RecordFilesOf(const std::vector<std::filesystem::path>& paths);

}  // namespace strainwave::bench
