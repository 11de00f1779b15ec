// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

#include "daq/record.h"

namespace strainwave::daq {

/// Reads a record file that a user named: HDF5 with one record or many (by its signature, whatever its name),
/// and anything else as CSV with one. HDF5 is read in a process of its own (`record_pipe.h`); no other thread
/// may be within HDF5 meanwhile.
/// @throws RecordError with every finding, as `csv_record.h` and `cycle_file.h` say.
std::vector<Record> ReadRecords(const std::filesystem::path& path);

}  // namespace strainwave::daq
