// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <hdf5.h>

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "daq/cycle_file.h"
#include "daq/record.h"

/// Records as groups of an open HDF5 file; `FORMAT.md` says what stands where. Most callers want the whole
/// files of `cycle_file.h` and `read_records.h` and never see an HDF5 identifier.
namespace strainwave::daq {

/// Writes `record` as the group `group_path` ("/hysteresis", "/repeat/2/hysteresis", "/") of `file`.
/// Values are not judged, so that whatever was measured can be stored.
/// @throws std::invalid_argument if the record has no kind, no rows, columns of unequal length, or a name
///   that HDF5 or the reader would take for something else; Hdf5Error.
void WriteRecordGroup(hid_t file, const std::string& group_path, const Record& record,
                      Packing packing = Packing::kPlain);

/// Paths of all groups with an attribute `kind`, at any depth, the root among them, in the order of creation
/// where the file keeps it and else by name. Soft and external links are not followed.
/// @param nested  also those within the group of another record, for which every dataset is opened.
/// @throws Hdf5Error.
std::vector<std::string> ListRecordGroups(hid_t file, bool nested = true);

/// Reads one group back. `file_name` is for messages; `columns` as for `ReadCycleFile`.
/// @throws RecordError with every finding as `FILE: error: group '/x', dataset 'y', row 17: WHAT (expected
///   ...)`, rows counted from 0; Hdf5Error if the group is not there.
Record ReadRecordGroup(hid_t file, const std::string& group_path, const std::string& file_name,
                       Checking checking = Checking::kRules, std::span<const std::string_view> columns = {});

/// Writes and reads the attributes of the root group that belong to the file as a whole, but for the one that
/// says which program has written it.
/// @throws std::invalid_argument for a name that is empty or taken; Hdf5Error.
void WriteFileAttributes(hid_t file, const Attributes& attributes);
Attributes ReadFileAttributes(hid_t file);

}  // namespace strainwave::daq
