// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <vector>

#include "bench/campaign/journal.h"
#include "bench/campaign/pause.h"
#include "daq/checkpoint_file.h"

namespace strainwave::bench {

/// Where a campaign was at the last second of bench time that is safe on the disk.
struct Checkpoint {
  int cycle{};
  int step{};
  int repeat{};
  bool finished{};           // the phase has come to its end, and its records are kept
  double credited_load_s{};  // of this step, all attempts together
  double time_s{};           // bench time of the campaign
  Moment written{};          // that of a boot not known in checkpoints of earlier versions
  /// Input angle / ratio − output angle, to be found again before anything moves; a NaN when not known.
  double encoder_offset_rad{};
  std::uint64_t campaign{};  // Journal::Identity; 0 in checkpoints of earlier versions
  JournalEnd journal_end{};  // how far the journal was; zeros in checkpoints of earlier versions
  int damaged_states{};      // of those in the file, which this one was read from
  std::vector<std::byte> machine_memory{};  // BenchMachine::Memory
};

/// Writes checkpoints once a second of bench time, or, of a bench that runs faster than real time, every 5 ms
/// of the world's. A killed process loses none that was written. A power cut loses at most what came in the
/// last second of the world's time and while the disk was syncing: each is synced but those that come within
/// half a second of the one before.
class CheckpointWriter {
 public:
  explicit CheckpointWriter(const std::filesystem::path& file);
  /// Whether the one before is so old that a beat writes another.
  bool IsDue(std::chrono::steady_clock::time_point now = std::chrono::steady_clock::now()) const;
  /// @return whether it is on the disk.
  bool Write(const Checkpoint& checkpoint, std::span<const std::byte> machine_memory,
             std::chrono::steady_clock::time_point now = std::chrono::steady_clock::now());
  /// Waits until the last one is on the disk, as at both ends of a phase, before the journal says so.
  void Sync();

 private:
  daq::CheckpointFile file_;
  std::vector<std::byte> buffer_;
  std::chrono::steady_clock::time_point last_write_{};
  std::chrono::steady_clock::time_point last_sync_{};
};

/// The newest whole checkpoint of a file, or nothing.
std::optional<Checkpoint> ReadCheckpoint(const std::filesystem::path& file);

}  // namespace strainwave::bench
