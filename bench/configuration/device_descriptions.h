// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

namespace strainwave::bench {

/// A device, or a bus with several, and where it is found.
struct DeviceDescription {
  enum class Kind { kCanopen, kModbus, kStream, kIio, kPendant, kStoContact, kHid, kCamera };

  std::string name;
  Kind kind{};
  /// CAN interface ("can0", "in_process"), "tcp:HOST:PORT", "rtu:PATH:BAUD:8N1", URI of an IIO context, file
  /// or device of a camera; of the HID kinds empty, as their profile says which they are.
  std::string address;
  int unit{};                  // Modbus
  std::filesystem::path file;  // register map or HID profile, from where the program runs
  int line{};
};

/// The drive of a servo on a CAN bus (`node`, `profile`) or a Modbus device.
struct DriveLink {
  std::string device;  // empty: none is named
  int node{};
  std::filesystem::path profile;
};

/// Which device's channel feeds a channel of the bench.
struct ChannelLink {
  std::string channel;  // "input_angle", …, or the name of an accelerometer
  std::string device;
  std::string source;  // its name there
  int line{};
};

}  // namespace strainwave::bench
