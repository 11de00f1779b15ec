// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "bench/devices/hid/hid_channels.h"
#include "schedules/reader/findings.h"

namespace strainwave::bench {

/// A file of a HID device that cannot be used.
class HidProfileError : public schedules::FileError {
 public:
  using FileError::FileError;
};

/// Reads a file (`hid_device: 1`; those in bench/devices/profiles/ have every key).
/// @throws HidProfileError with every error of the file, each with line and column.
HidProfile ReadHidProfile(const std::filesystem::path& path);
/// The same for a text, which messages call `file_name`.
HidProfile ParseHidProfile(const std::string& text, std::string_view file_name);

}  // namespace strainwave::bench
