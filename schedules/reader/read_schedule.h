// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "schedules/reader/schedule.h"

namespace strainwave::schedules {

/// Reads and validates a schedule file (schedules/README.md). Warnings are to be had from
/// `ValidateSchedule` on the result.
/// @throws ScheduleError with every error of the file, if there is one.
Schedule ReadSchedule(const std::filesystem::path& path);

/// The same for a text, which messages call `file_name`.
Schedule ParseSchedule(const std::string& text, std::string_view file_name);

}  // namespace strainwave::schedules
