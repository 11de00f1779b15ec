// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <exception>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "daq/acquisition/gap_ledger.h"
#include "daq/acquisition/sample_source.h"
#include "daq/acquisition/spsc_ring.h"
#include "daq/acquisition/stream_file_writer.h"

namespace strainwave::daq::acquisition {

struct RecorderSettings {
  std::filesystem::path folder{};
  std::string name{};                    // files are NAME-000001.h5, NAME-000002.h5 ...
  std::uint64_t most_rows_a_file{};      // a new file begins with the first block after so many
  std::size_t ring_blocks{};             // how many blocks may wait while the disk is slow
  std::uint64_t rows_between_flushes{};  // what a killed process loses at most, beside what waits
  Attributes attributes{};               // of every file: specimen, time of day at the start ...
};

/// What became of the blocks so far.
struct RecorderTotals {
  GapTotals samples{};                  // a channel
  std::uint64_t blocks_without_room{};  // found the ring full; their samples are among the lost
  std::uint64_t not_written{};          // samples among those received that writing failed for
  std::uint64_t files{};                // finished
  std::uint64_t peak_waiting{};         // most blocks that waited in the ring
};

/// Writes the blocks of one source to HDF5 files on a thread of its own. One thread hands blocks over and
/// never waits for the disk. Losses, of the device and of the ring, are found where blocks are written, so
/// that the file has them all.
class StreamRecorder {
 public:
  /// The first file's number follows the highest one of that name in the folder, unfinished files included.
  /// @throws std::invalid_argument for settings that hold nothing; DataFileError.
  StreamRecorder(const RecorderSettings& settings, SourceDescription source);
  StreamRecorder(const StreamRecorder&) = delete;
  StreamRecorder& operator=(const StreamRecorder&) = delete;
  /// Finishes the open file; what goes wrong then is told by `Finish()` alone.
  ~StreamRecorder();

  /// Copies the block, never waits. False if there was no room: then it is lost, and counted.
  /// @throws std::length_error if it is longer than the source said.
  bool Push(const SampleBlock& block);

  /// After the last `Push`: writes what waits, finishes the file and ends the thread.
  /// @throws DataFileError, std::invalid_argument: why writing ended early; the unfinished file stays.
  void Finish();

  /// Any thread.
  RecorderTotals totals() const;
  /// Any thread: writing has ended early; `Finish()` says why. Blocks are then dropped and counted as lost.
  bool has_failed() const noexcept { return has_failed_.load(std::memory_order_acquire); }

 private:
  void Write() noexcept;
  void WriteBlock(SampleBlock& block) noexcept;
  void CloseFile();
  template <typename Call>
  void Guarded(Call call) noexcept;
  std::filesystem::path NextPath();

  const RecorderSettings settings_;
  const SourceDescription source_;
  SpscRing<SampleBlock> ring_;
  GapLedger ledger_;                        // the writing thread's
  std::unique_ptr<StreamFileWriter> file_;  // the writing thread's
  std::optional<BlockHeader> refused_;      // the last block, if it found no room; the pushing thread's
  std::uint64_t next_number_{};
  std::uint64_t unflushed_rows_{};
  mutable std::mutex totals_mutex_;  // between the writing thread and who asks; never the pushing one
  RecorderTotals totals_;
  std::exception_ptr failure_;
  std::atomic<bool> has_failed_{false};
  std::atomic<std::uint32_t> doorbell_{0};
  std::atomic<bool> ends_{false};
  std::thread writer_;
};

}  // namespace strainwave::daq::acquisition
