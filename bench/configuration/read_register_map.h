// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "bench/devices/modbus/modbus_servo_profile.h"
#include "protocols/modbus/register_map.h"
#include "schedules/reader/findings.h"

namespace strainwave::bench {

/// A Modbus device as its file describes it.
struct ModbusProfile {
  protocols::modbus::RegisterMap map;
  std::optional<ModbusServoProfile> servo;
};

/// A file of a Modbus device that cannot be used.
class ModbusProfileError : public schedules::FileError {
 public:
  using FileError::FileError;
};

/// Reads a file (`modbus_device: 1`; those in bench/devices/profiles/ have every key). Units of the field
/// (rpm, Ncm, ms) become SI here, once: scale, offset and limits of a register are then in `Register::unit`.
/// @throws ModbusProfileError with every error of the file, each with line and column.
ModbusProfile ReadModbusProfile(const std::filesystem::path& path);
/// The same for a text, which messages call `file_name`.
ModbusProfile ParseModbusProfile(const std::string& text, std::string_view file_name);

}  // namespace strainwave::bench
