// SPDX-License-Identifier: Apache-2.0
// Any bytes as an HDF5 file of records, read in a process of its own, which alone may fail.
// longest: 65536
#include <cstdint>
#include <cstdlib>
#include <iterator>
#include <vector>

#include "daq/read_records.h"
#include "daq/record_error.h"
#include "tests/fuzz/file_in_memory.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace strainwave::daq;
  constexpr std::uint8_t kSignature[] = {0x89, 'H', 'D', 'F', '\r', '\n', 0x1a, '\n'};
  std::vector<std::uint8_t> bytes(kSignature, std::end(kSignature));
  bytes.insert(bytes.end(), data, data + size);
  const FileInMemory file(std::as_bytes(std::span(bytes)));
  try {
    for (const Record& record : ReadRecords(file.path())) {
      for (const Column& column : record.columns) {
        if (column.size() != record.rows()) std::abort();
      }
    }
  } catch (const RecordError& error) {
    if (error.findings().empty()) std::abort();
  }
  return 0;
}
