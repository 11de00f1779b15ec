// SPDX-License-Identifier: Apache-2.0
// Any text as a CSV record that is replayed.
// sources: daq/acquisition/calibration.cc daq/acquisition/sources/replay_source.cc
// sources: daq/acquisition/stream_file_reader.cc daq/acquisition/stream_tables.cc daq/acquisition/teds.cc
// sources: daq/csv_record.cc daq/csv_text.cc daq/cycle_file.cc daq/hdf5_attributes.cc daq/hdf5_column.cc
// sources: daq/hdf5_handle.cc daq/hdf5_image.cc daq/hdf5_record.cc daq/hdf5_text.cc daq/read_records.cc
// sources: daq/csv_form.cc daq/direction_words.cc daq/file_descriptor.cc daq/large_memory.cc daq/limited_process.cc daq/record.cc daq/record_kind.cc daq/record_error.cc
// sources: daq/record_pipe.cc daq/record_rules.cc daq/sensor_serials.cc daq/software.cc daq/value_bounds.cc daq/whole_file.cc
// libraries: fmt hdf5-serial zlib
// flags: -fsanitize=float-cast-overflow
#include <cstdint>

#include "tests/fuzz/replay_check.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const FileInMemory file(std::as_bytes(std::span(data, size)));
  ReplayToTheEnd(file.path(), 1 + static_cast<std::uint32_t>(size % 7), true);
  return 0;
}
