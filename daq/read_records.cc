// SPDX-License-Identifier: Apache-2.0
#include "daq/read_records.h"

#include <algorithm>

#include "daq/csv_record.h"
#include "daq/cycle_file.h"
#include "daq/hdf5_handle.h"
#include "daq/record_pipe.h"

namespace strainwave::daq {
namespace {

// The library's own test also finds the signature behind a user block, as in MATLAB's files. It opens the
// file, which a pipe does not outlive, so only plain files are asked.
bool IsHdf5(const std::filesystem::path& path) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(path, ignored)) return false;
  const Hdf5Silence silence;
  return H5Fis_hdf5(path.c_str()) > 0;
}

}  // namespace

std::vector<Record> ReadRecords(const std::filesystem::path& path) {
  std::vector<Record> records;
  if (!IsHdf5(path)) {
    records.push_back(ReadCsvRecord(path));
    return records;
  }
  return ReadInOwnProcess(path, LimitsForFile(path), [&path] {
    std::vector<Record> read;
    CycleFile file = ReadCycleFile(path);
    const auto specimen = std::ranges::find(file.attributes, "specimen", &Attributes::value_type::first);
    for (NamedRecord& named : file.records) {
      read.push_back(std::move(named.record));
      if (specimen != file.attributes.end()) read.back().source.specimen = specimen->second;
    }
    return read;
  });
}

}  // namespace strainwave::daq
