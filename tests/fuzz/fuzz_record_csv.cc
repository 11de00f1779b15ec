// SPDX-License-Identifier: Apache-2.0
// Any text as a CSV record; what is accepted, written again, is read as the same values.
#include <cstdint>
#include <cstdlib>

#include "daq/csv_record.h"
#include "daq/record_error.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace strainwave::daq;
  Record record;
  try {
    record = ParseCsvRecord({reinterpret_cast<const char*>(data), size}, "any.csv");
  } catch (const RecordError& error) {
    if (error.findings().empty()) std::abort();
    return 0;
  }
  const Record again = ParseCsvRecord(CsvTextOf(record), "written.csv");
  if (again.columns.size() != record.columns.size() || again.rows() != record.rows()) std::abort();
  return 0;
}
