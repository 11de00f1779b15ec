// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <span>

#include "daq/record.h"

namespace strainwave::bench {

/// Writes records in the format that the name ends in: .csv (one record), .h5 or .hdf5, .mat (MAT 5), .uff or
/// .unv (UFF 58). The file appears whole or not at all.
/// @throws BenchError for another ending, or several records in a format that holds one.
void WriteRecords(std::span<const daq::Record> records, const std::filesystem::path& path);

}  // namespace strainwave::bench
