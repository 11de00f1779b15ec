// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "daq/acquisition/sample_source.h"
#include "daq/acquisition/stream_tables.h"
#include "daq/cycle_file.h"
#include "daq/hdf5_handle.h"

namespace strainwave::daq::acquisition {

/// Whether the file holds a stream (`daq/FORMAT.md`, "A stream"), and not records. @throws RecordError if it
/// cannot be read at all.
bool IsStreamFile(const std::filesystem::path& path);

/// Reads a file of a stream, also one that is being written or whose writer was killed: then what was
/// flushed.
class StreamFileReader {
 public:
  /// @throws RecordError: no such file, no stream, or a file that contradicts itself.
  explicit StreamFileReader(const std::filesystem::path& path);

  const SourceDescription& description() const { return description_; }
  const Attributes& attributes() const { return attributes_; }  // of the file, the source's own among them
  const std::vector<BlockRow>& blocks() const { return blocks_; }
  const std::vector<GapRow>& gaps() const { return gaps_; }
  std::uint64_t rows() const { return rows_; }

  /// Raw values of `count` rows from `row` on, sample after sample. @throws RecordError for a damaged chunk,
  /// std::out_of_range.
  std::vector<std::uint32_t> Words(std::uint64_t row, std::uint64_t count) const;

  /// One channel, scaled; with the calibration that the file has where none is given. @throws as above.
  std::vector<double> Values(std::size_t channel, const std::optional<Calibration>& calibration = {}) const;

 private:
  void ReadHead();
  void ReadChannels();
  void ReadTables();
  [[noreturn]] void Refuse(const std::string& what, const std::string& expected) const;

  std::string path_;
  Hdf5Silence silence_;
  std::optional<Hdf5Handle> file_;
  std::optional<Hdf5Handle> samples_;
  SourceDescription description_;
  Attributes attributes_;
  std::vector<BlockRow> blocks_;
  std::vector<GapRow> gaps_;
  std::uint64_t rows_{};
};

}  // namespace strainwave::daq::acquisition
