// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <vector>

#include "daq/acquisition/sample_source.h"
#include "daq/acquisition/stream_file_reader.h"

namespace strainwave::daq::acquisition {

struct ReplaySettings {
  std::filesystem::path path;
  /// Seconds of the record a second; 0 for as fast as it is asked for, with the arrival times of the record.
  double speed{};
  std::uint32_t samples_a_block{512};  // of a record; a stream keeps the blocks that it came in
};

/// Replays a file: a stream as it was recorded, block by block with its counters, times and gaps; or a record
/// (CSV or HDF5, the first one of a file), its columns as float32 channels. A record's rate is its
/// `sample_rate_hz` or else the inverse of the median step of `time_s`; rows that are missing on that grid
/// are a gap.
class ReplaySource : public SampleSource {
 public:
  explicit ReplaySource(ReplaySettings settings) : settings_(std::move(settings)) {}

  /// @throws RecordError for a file that cannot be read, a record without a rate, or one that is
  ///   longer than 64 bits count nanoseconds.
  void Start() override;
  void Stop() noexcept override;
  NextResult Next(SampleBlock& block, std::chrono::nanoseconds patience) override;
  const SourceDescription& description() const override { return description_; }

 private:
  void StartRecord();
  NextResult NextOfStream(SampleBlock& block);
  NextResult NextOfRecord(SampleBlock& block);
  std::chrono::nanoseconds DueTime() const;

  ReplaySettings settings_;
  SourceDescription description_;
  std::unique_ptr<StreamFileReader> stream_;
  std::size_t next_block_{};
  std::vector<std::vector<double>> columns_;
  std::vector<std::uint64_t> counters_;  // of each row, on the grid of the rate
  std::size_t next_row_{};
  std::chrono::nanoseconds began_{};
};

}  // namespace strainwave::daq::acquisition
