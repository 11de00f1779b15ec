// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <string_view>
#include <vector>

#include "daq/arrays_file.h"
#include "daq/limited_process.h"
#include "daq/record.h"
#include "daq/record_error.h"

/// Files of others, read in a process of their own: a library can crash, hang or take all memory on a file
/// that was made to do so, and on some that were only damaged.
namespace strainwave::daq {

/// Memory and time that a file of that size may take.
ProcessLimits LimitsForFile(const std::filesystem::path& path);

/// What `read` gives, which runs in that process, as it stands in memory here. Messages say that `reader`
/// failed.
/// @throws RecordError as `read` throws it, and where the process ends otherwise:
///   "FILE: error: the HDF5 library cannot read the file: it crashed (Segmentation fault) (expected ...)".
std::vector<Record> ReadInOwnProcess(const std::filesystem::path& path, const ProcessLimits& limits,
                                     const std::function<std::vector<Record>()>& read,
                                     std::string_view reader = "the HDF5 library");
/// The same for a file of arrays.
ArraysFile ReadArraysInOwnProcess(const std::filesystem::path& path, const ProcessLimits& limits,
                                  const std::function<ArraysFile()>& read);

}  // namespace strainwave::daq
