// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "daq/cycle_file.h"

/// Files of records that may be damaged, looked at in a process of their own: on some of them the HDF5
/// library crashes.
namespace strainwave::daq {

struct RecordCheck {
  std::string group;
  std::string damage;  // what is wrong with it; empty: whole
};

/// Which records of a file can be read, each byte of them against its checksum; values are not judged.
/// @throws RecordError if not even the list of records can be read.
std::vector<RecordCheck> CheckRecords(const std::filesystem::path& path);

/// Reads a file once: that can be done again in this process then, without a crash.
/// @throws RecordError if it cannot be read.
void DemandReadable(const std::filesystem::path& path);

/// Writes records of such a file that are whole, bit for bit, as a file of their own that appears whole or
/// not at all.
/// @param groups  that `CheckRecords` has found whole: reading them again is safe here.
/// @throws RecordError, DataFileError.
void CopyRecords(const std::filesystem::path& from, std::span<const std::string> groups,
                 const std::filesystem::path& to, const Attributes& attributes);

}  // namespace strainwave::daq
