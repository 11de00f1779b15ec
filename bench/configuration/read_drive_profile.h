// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "bench/configuration/read_bench_file.h"
#include "protocols/canopen/drive_profile.h"

namespace strainwave::bench {

/// Reads the profile of a type of drive (`drive_profile: 1`): what another maker's drive needs instead of
/// code. Where it names its maker's EDS file, it is checked against that. Speeds, torques and angles in the
/// file are those of the motor shaft; so are the profile's limits here.
/// @throws BenchFileError with every error of the file, if there is one.
protocols::canopen::DriveProfile ReadDriveProfile(const std::filesystem::path& path);

/// The same for a text, which messages call `file_name`; the EDS file is looked for in `folder`.
protocols::canopen::DriveProfile ParseDriveProfile(const std::string& text, std::string_view file_name,
                                                   const std::filesystem::path& folder = {});

/// The profile of a drive whose motor turns the axis through a reducer: limits and units are then those of
/// the axis. `sign` is −1 where the motor's positive is the axis's negative.
protocols::canopen::DriveProfile AtAxis(protocols::canopen::DriveProfile profile, double gear_ratio,
                                        int sign);

}  // namespace strainwave::bench
