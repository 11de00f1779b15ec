// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <system_error>
#include <vector>

#include "daq/file_descriptor.h"

namespace strainwave::daq {

/// What the newest good slot of a checkpoint file holds.
struct Checkpoint {
  std::uint64_t sequence{};  // counts the writes, from 1
  std::vector<std::byte> payload;
  int damaged_slots{};  // slots with something in them that is not good, such as a write that was cut

  bool operator==(const Checkpoint&) const = default;
};

/// A small state, written again and again, that outlives its process: a kill at any moment costs at most the
/// write that was going on, a power cut at most what came after the last `Sync()`. Three slots of fixed size
/// in one file, each with a checksum; a write never touches the newest slot nor the newest one that is on the
/// disk. `FORMAT.md` has the layout. One writer at a time; any number of readers.
class CheckpointFile {
 public:
  static constexpr std::size_t kSlots = 3;
  static constexpr std::size_t kSlotStride_bytes = 16384;
  static constexpr std::size_t kHeader_bytes = 32;
  static constexpr std::size_t kCapacity_bytes = kSlotStride_bytes - kHeader_bytes;

  /// Opens the file to write, or makes an empty one, which appears whole or not at all.
  /// @throws DataFileError if that fails, and if the file is none of this format or all that was written is
  ///   damaged: a state that was lost is never taken for one that was not begun.
  explicit CheckpointFile(const std::filesystem::path& path);

  /// Writes the next state: one system call, no allocation, nothing waits for the disk.
  /// @throws std::invalid_argument if `payload` is longer than `kCapacity_bytes`; DataFileError, also after a
  /// sync
  ///   that failed.
  void Write(std::span<const std::byte> payload);

  /// Waits until everything written is on the disk.
  /// @throws DataFileError; what was written since the last sync may then be lost in a power cut. The kernel
  /// says
  ///   so once and takes the next sync for good, so each call throws from then on.
  void Sync();

  /// The newest state, also one of a process before; nothing if there was none. @throws DataFileError as
  /// above.
  std::optional<Checkpoint> ReadLatest() const;

 private:
  void RenewNewest();
  void DemandSynced() const;

  std::filesystem::path path_;
  FileDescriptor file_;
  std::uint64_t sequence_{};  // of the newest write
  std::size_t newest_slot_{};
  std::size_t synced_slot_{};
  std::error_code failed_sync_;
  std::array<std::byte, kSlotStride_bytes> buffer_{};
};

/// Reads the newest state of a file that another process may be writing; nothing if nothing was written yet.
/// @throws DataFileError if it cannot be read, is none of this format, or all that was written is damaged.
std::optional<Checkpoint> ReadCheckpoint(const std::filesystem::path& path);

}  // namespace strainwave::daq
