// SPDX-License-Identifier: Apache-2.0
#include "bench/records/write_record.h"

#include <string>

#include <fmt/format.h>

#include "bench/errors/bench_error.h"
#include "daq/csv_record.h"
#include "daq/cycle_file.h"
#include "daq/import/write_foreign.h"
#include "daq/whole_file.h"

namespace strainwave::bench {
namespace {

void WriteHdf5(std::span<const daq::Record> records, const std::filesystem::path& path) {
  std::vector<daq::NamedRecord> named;
  for (const daq::Record& record : records) {
    std::string name = record.source.group.empty() ? std::string(record.kind.name()) : record.source.group;
    if (records.size() > 1 && record.source.group.empty()) name += fmt::format("_{}", named.size() + 1);
    named.push_back({std::move(name), record});
  }
  daq::WriteRecordsAtomically(path, named);
}

}  // namespace

void WriteRecords(std::span<const daq::Record> records, const std::filesystem::path& path) {
  if (path.has_parent_path()) std::filesystem::create_directories(path.parent_path());
  const std::string ending = path.extension().string();
  if (ending == ".h5" || ending == ".hdf5") return WriteHdf5(records, path);
  if (ending == ".uff" || ending == ".unv") return daq::WriteFileAtomically(path, daq::UffTextOf(records));
  if (records.size() > 1)
    Refuse(path, fmt::format("{} records", records.size()),
           "one, by --group NAME, or a name that ends in .h5");
  if (ending == ".mat") return daq::WriteMatFile(records.front(), path);
  if (ending != ".csv" && !ending.empty() && ending != ".txt")
    Refuse(path, fmt::format("'{}' is no ending that is known", ending), ".csv, .h5, .mat, .uff");
  daq::WriteCsvRecord(records.front(), path);
}

}  // namespace strainwave::bench
