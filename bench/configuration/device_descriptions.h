// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace strainwave::bench {

/// How a Modbus device is to be talked to, where the file says something else than is usual.
struct ModbusConnection {
  std::optional<std::chrono::milliseconds> answer_time;
  std::optional<int> retries;
  std::optional<bool> answers_echo;  // the rest: of a line
  std::optional<int> baud;
  std::optional<char> parity;
  std::optional<int> stop_bits;
};

/// A device, or a bus with several, and where it is found.
struct DeviceDescription {
  enum class Kind {
    kCanopen,
    kModbus,
    kTorqueAmplifier,        // on Modbus
    kTemperatureController,  // the same
    kStream,
    kIio,
    kPendant,
    kStoContact,
    kHid,
    kCamera
  };

  std::string name;
  Kind kind{};
  /// CAN interface ("can0", "in_process"), "tcp:HOST:PORT", "rtu:PATH:BAUD:8N1", URI of an IIO context, file
  /// or device of a camera; of the HID kinds empty, as their profile says which they are.
  std::string address;
  int unit{};                            // Modbus
  ModbusConnection connection;           // Modbus
  std::optional<double> set_point_degC;  // of a temperature controller; nothing: it is not to heat
  std::string iio_device;                // name or id within the IIO context: "adxl355"
  std::filesystem::path file;            // register map or HID profile, from where the program runs
  int line{};
};

/// Whether devices of a kind are talked to over Modbus.
bool IsOnModbus(DeviceDescription::Kind kind);

/// The device of that name, or null.
const DeviceDescription* FindDevice(std::span<const DeviceDescription> devices, std::string_view name);

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

/// A register that a bench of metal switches something with.
struct SwitchLink {
  std::string device;  // on Modbus; empty: there is none
  std::string source;  // its register
};

}  // namespace strainwave::bench
