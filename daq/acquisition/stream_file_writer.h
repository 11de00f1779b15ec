// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <hdf5.h>

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <optional>

#include "daq/acquisition/gap_ledger.h"
#include "daq/acquisition/sample_source.h"
#include "daq/cycle_file.h"
#include "daq/hdf5_handle.h"

namespace strainwave::daq::acquisition {

/// One file of a stream (`daq/FORMAT.md`, "A stream"), written as the blocks come. It stands as
/// `.NAME.partial` until `Close()`, and can be read meanwhile by others (HDF5's single writer, many readers).
/// Memory does not grow with the file.
class StreamFileWriter {
 public:
  /// @throws std::invalid_argument if a channel has no name, one name is there twice, or it holds a slash;
  ///   DataFileError.
  StreamFileWriter(std::filesystem::path path, const SourceDescription& source, const Attributes& attributes);
  StreamFileWriter(const StreamFileWriter&) = delete;
  StreamFileWriter& operator=(const StreamFileWriter&) = delete;
  /// Without `Close()` the partial file stays, with what was flushed.
  ~StreamFileWriter();

  /// @throws std::invalid_argument if the block has other channels or another type than the source;
  ///   DataFileError.
  void Append(const SampleBlock& block, const std::optional<Gap>& gap);

  /// A gap with no block after it.
  void AppendGap(const Gap& gap);

  /// Hands to the operating system what came so far: a killed process does not lose it, a reader sees it.
  void Flush();

  /// Flush, fsync, rename to the file's name, fsync of the folder. @throws DataFileError.
  void Close();

  std::uint64_t rows() const { return rows_; }
  const std::filesystem::path& partial_path() const { return partial_; }

 private:
  // A dataset that grows at its end.
  struct Table {
    Hdf5Handle dataset;
    Hdf5Handle memory_type;
    std::uint64_t rows{};
  };
  void AppendRows(Table& table, const void* rows, std::uint64_t count, std::uint32_t channels);
  template <typename Call>
  void Guarded(const char* doing, Call call);

  std::filesystem::path path_;
  std::filesystem::path partial_;
  SampleType type_;
  std::uint32_t channels_;
  std::uint64_t rows_{};
  // In the order of their making; they close from the last to the first.
  std::optional<Hdf5Handle> file_;
  std::optional<Table> samples_;
  std::optional<Table> blocks_;
  std::optional<Table> gaps_;
};

}  // namespace strainwave::daq::acquisition
