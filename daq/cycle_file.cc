// SPDX-License-Identifier: Apache-2.0
#include "daq/cycle_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <stdexcept>

#include "daq/data_file_error.h"
#include "daq/hdf5_handle.h"
#include "daq/hdf5_record.h"
#include "daq/record_error.h"
#include "daq/whole_file.h"

namespace strainwave::daq {
namespace {

constexpr std::size_t kMemoryStep = std::size_t{1} << 20;
constexpr char kFormatName[] = "strainwave_format";
constexpr char kFormatVersion[] = "1";

std::string PathOf(const std::string& group) { return group.starts_with('/') ? group : "/" + group; }

// The library builds the file in memory and the operating system writes it: a full disk then meets a plain
// write(), which says so, and not a library that holds half-written caches and tries again on closing.
Hdf5Handle CreateInMemory() {
  const Hdf5Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  Check(H5Pset_fapl_core(access.get(), kMemoryStep, false));
  // A superblock of version 2: the next one says "open for writing" until it is closed.
  Check(H5Pset_libver_bounds(access.get(), H5F_LIBVER_V18, H5F_LIBVER_V18));
  const Hdf5Handle creation(H5Pcreate(H5P_FILE_CREATE), H5Pclose);
  Check(H5Pset_link_creation_order(creation.get(), H5P_CRT_ORDER_TRACKED | H5P_CRT_ORDER_INDEXED));
  Check(H5Pset_attr_creation_order(creation.get(), H5P_CRT_ORDER_TRACKED | H5P_CRT_ORDER_INDEXED));
  Check(H5Pset_obj_track_times(creation.get(), false));
  Hdf5Handle file(H5Fcreate("in_memory.h5", H5F_ACC_TRUNC, creation.get(), access.get()), H5Fclose);
  // From 1.10 on the index of chunks carries a checksum as everything else does; before, a flipped bit in it
  // could read as another value.
  Check(H5Fset_libver_bounds(file.get(), H5F_LIBVER_V110, H5F_LIBVER_V110));
  return file;
}

// H5Fget_file_image would clear the flags of the superblock without renewing its checksum (1.10), which makes
// a file that cannot be opened; the driver's own memory is the file as it stands after a flush.
std::vector<std::byte> ImageOf(hid_t file) {
  Check(H5Fflush(file, H5F_SCOPE_GLOBAL));
  const ssize_t size = Check(H5Fget_file_image(file, nullptr, 0));  // without the room the driver keeps
  void* memory{};
  Check(H5Fget_vfd_handle(file, H5P_DEFAULT, &memory));
  const auto* const bytes = *static_cast<const std::byte* const*>(memory);
  return {bytes, bytes + size};
}

}  // namespace

void WriteRecordsAtomically(const std::filesystem::path& path, std::span<const NamedRecord> records,
                            const Attributes& attributes) {
  if (records.empty()) throw std::invalid_argument(fmt::format("no record to write to '{}'", path.string()));
  std::set<std::string> groups;
  for (const NamedRecord& named : records) {
    if (PathOf(named.group) == "/")
      throw std::invalid_argument("a record of a cycle file has a group of its own");
    if (groups.insert(PathOf(named.group)).second) continue;
    throw std::invalid_argument(fmt::format("two records have the group '{}'", PathOf(named.group)));
  }
  const Hdf5Silence silence;
  std::vector<std::byte> image;
  try {
    const Hdf5Handle file = CreateInMemory();
    Attributes with_format{{kFormatName, kFormatVersion}};
    with_format.insert(with_format.end(), attributes.begin(), attributes.end());
    WriteFileAttributes(file.get(), with_format);
    for (const NamedRecord& named : records) WriteRecordGroup(file.get(), PathOf(named.group), named.record);
    image = ImageOf(file.get());
  } catch (const Hdf5Error& error) {
    throw DataFileError(std::make_error_code(std::errc::io_error),
                        fmt::format("cannot build ({}) the HDF5 file", error.what()), path.string());
  }
  WriteFileAtomically(path, image);
}

CycleFile ReadCycleFile(const std::filesystem::path& path, Checking checking) {
  const Hdf5Silence silence;
  const std::string name = path.string();
  const Hdf5Handle file = OpenHdf5ForReading(path);
  CycleFile result;
  std::vector<Finding> findings;
  try {
    const std::vector<std::string> groups = ListRecordGroups(file.get());
    if (groups.empty()) {
      throw RecordError(name, "no record is in the file", "a group with the attribute 'kind'");
    }
    // A record in the root group has the root's attributes for its own.
    if (groups.front() != "/") result.attributes = ReadFileAttributes(file.get());
    std::erase_if(result.attributes, [](const auto& attribute) { return attribute.first == kFormatName; });
    for (const std::string& group : groups) {
      try {
        result.records.push_back({group, ReadRecordGroup(file.get(), group, name, checking)});
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
