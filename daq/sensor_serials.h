// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace strainwave::daq {

/// The sensors that a file of records (`cycle_file.h`) was measured with: "torque_Nm=SN-1" once for each
/// column and serial number, sorted. Reads attributes alone, no values.
/// @throws RecordError if the file is missing or not to be read.
std::vector<std::string> ReadSensorSerials(const std::filesystem::path& path);

}  // namespace strainwave::daq
