// SPDX-License-Identifier: Apache-2.0
#include "daq/cycle_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <stdexcept>

#include "daq/data_file_error.h"
#include "daq/hdf5_handle.h"
#include "daq/hdf5_image.h"
#include "daq/hdf5_record.h"
#include "daq/record_error.h"
#include "daq/whole_file.h"

namespace strainwave::daq {
namespace {

constexpr char kFormatName[] = "strainwave_format";
constexpr char kFormatVersion[] = "1";

std::string PathOf(const std::string& group) { return group.starts_with('/') ? group : "/" + group; }

}  // namespace

Attributes WithFormat(const Attributes& attributes) {
  Attributes with_format{{kFormatName, kFormatVersion}};
  with_format.insert(with_format.end(), attributes.begin(), attributes.end());
  return with_format;
}

void SetUpHdf5() { const Hdf5Silence first_use; }

std::vector<std::byte> ImageOfRecords(std::span<const NamedRecord> records, const Attributes& attributes,
                                      const std::filesystem::path& path, Packing packing) {
  if (records.empty()) throw std::invalid_argument(fmt::format("no record to write to '{}'", path.string()));
  std::set<std::string> groups;
  for (const NamedRecord& named : records) {
    if (PathOf(named.group) == "/")
      throw std::invalid_argument("a record of a cycle file has a group of its own");
    if (groups.insert(PathOf(named.group)).second) continue;
    throw std::invalid_argument(fmt::format("two records have the group '{}'", PathOf(named.group)));
  }
  const Hdf5Silence silence;
  try {
    const Hdf5Handle file = CreateHdf5InMemory();
    WriteFileAttributes(file.get(), WithFormat(attributes));
    for (const NamedRecord& named : records) {
      WriteRecordGroup(file.get(), PathOf(named.group), named.record, packing);
    }
    return ImageOfHdf5(file.get());
  } catch (const Hdf5Error& error) {
    throw DataFileError(std::make_error_code(std::errc::io_error),
                        fmt::format("cannot build ({}) the HDF5 file", error.what()), path.string());
  }
}

void WriteRecordsAtomically(const std::filesystem::path& path, std::span<const NamedRecord> records,
                            const Attributes& attributes) {
  WriteFileAtomically(path, ImageOfRecords(records, attributes, path, Packing::kPlain));
}

CycleFile ReadCycleFile(const std::filesystem::path& path, Checking checking,
                        std::span<const std::string_view> columns) {
  const Hdf5Silence silence;
  const std::string name = path.string();
  const Hdf5Handle file = OpenHdf5ForReading(path);
  CycleFile result;
  std::vector<Finding> findings;
  try {
    const std::vector<std::string> groups = ListRecordGroups(file.get(), columns.empty());
    if (groups.empty()) {
      throw RecordError(name, "no record is in the file", "a group with the attribute 'kind'");
    }
    // A record in the root group has the root's attributes for its own.
    if (groups.front() != "/") result.attributes = ReadFileAttributes(file.get());
    std::erase_if(result.attributes, [&](const auto& attribute) {
      if (attribute.first != kFormatName) return false;
      if (attribute.second == kFormatVersion) return true;
      throw RecordError(name, fmt::format("attribute '{}' is {}", kFormatName, attribute.second),
                        fmt::format("{}, the format that this version reads", kFormatVersion));
    });
    for (const std::string& group : groups) {
      try {
        result.records.push_back({group, ReadRecordGroup(file.get(), group, name, checking, columns)});
      } catch (const RecordError& error) {
        findings.insert(findings.end(), error.findings().begin(), error.findings().end());
      }
    }
  } catch (const Hdf5Error& error) {
    throw RecordError(name, fmt::format("HDF5 cannot read the file: {}", error.what()),
                      "the file as it was written");
  }
  if (!findings.empty()) throw RecordError(std::move(findings));
  return result;
}

}  // namespace strainwave::daq
