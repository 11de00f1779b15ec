// SPDX-License-Identifier: Apache-2.0
// Any bytes as a CSV file of any dialect.
// sources: daq/import/csv_dialect.cc daq/import/foreign_file.cc daq/import/mapped_file.cc daq/import/read_audio.cc
// sources: daq/import/read_csv_channels.cc daq/import/read_hdf5_channels.cc daq/import/read_mat.cc
// sources: daq/import/read_tdms.cc daq/import/tdms_values.cc daq/import/read_uff.cc daq/import/record_map.cc daq/import/units.cc
// sources: daq/csv_text.cc daq/direction_words.cc daq/file_descriptor.cc daq/hdf5_attributes.cc daq/hdf5_column.cc daq/hdf5_handle.cc
// sources: daq/hdf5_text.cc daq/joint_columns.cc daq/large_memory.cc daq/record.cc daq/record_error.cc daq/record_kind.cc
// sources: daq/record_rules.cc daq/software.cc daq/value_bounds.cc daq/whole_file.cc
// libraries: fmt hdf5-serial matio sndfile zlib
// flags: -fsanitize=float-cast-overflow
#include <cstdint>

#include "tests/fuzz/import_check.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  ReadAndMap(std::as_bytes(std::span(data, size)), strainwave::daq::ReadCsvChannels);
  return 0;
}
