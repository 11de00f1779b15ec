// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "daq/record.h"

/// Records as other programs read them.
namespace strainwave::daq {

/// MAT 5: a column vector a column under its name, metadata and kind as texts; directions are 1 and −1.
/// Names that MATLAB would not take are changed. Appears whole or not at all.
/// @throws DataFileError.
void WriteMatFile(const Record& record, const std::filesystem::path& path);

/// UFF 58: a function of time a column, in double precision, even in time where the record is, with the unit
/// of the column. The first line of each names the column, the others kind and metadata.
/// @throws std::invalid_argument if a record has no time.
std::string UffTextOf(std::span<const Record> records);

}  // namespace strainwave::daq
