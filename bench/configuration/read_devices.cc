// SPDX-License-Identifier: Apache-2.0
#include "bench/configuration/read_devices.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "bench/roles/sampler.h"

namespace strainwave::bench {

using schedules::Presence;
using schedules::ReadContext;
using schedules::YamlMap;
using Kind = DeviceDescription::Kind;

namespace {

constexpr int kMostNodes = 127;
constexpr int kMostUnits = 247;

std::filesystem::path Below(const std::filesystem::path& folder, const std::string& file) {
  return file.empty() ? std::filesystem::path() : folder / file;
}

bool IsAngle(std::string_view channel) { return channel == "input_angle" || channel == "output_angle"; }

bool IsAccelerometer(std::string_view channel) {
  return std::ranges::find(kAccelerometers, channel) != kAccelerometers.end();
}

// What is polled is older by an unknown part of the poll: arcminutes of an angle under way. Nor is it counted
// on where a register goes over.
bool DatesItsSamples(Kind kind) { return kind == Kind::kStream || kind == Kind::kIio; }

bool GivesChannels(Kind kind) {
  switch (kind) {
    case Kind::kModbus:
    case Kind::kTorqueAmplifier:
    case Kind::kTemperatureController:
    case Kind::kStream:
    case Kind::kIio:
    case Kind::kHid:
      return true;
    case Kind::kCanopen:
    case Kind::kPendant:
    case Kind::kStoContact:
    case Kind::kCamera:
      return false;
  }
  return false;
}

bool IsChannel(const BenchDescription& bench, std::string_view name) {
  const auto is_name = [&](const char* known) { return name == known; };
  return std::ranges::any_of(kNeededChannels, is_name) || std::ranges::any_of(kFurtherChannels, is_name) ||
         std::ranges::find(bench.accelerometers, name, &AccelerometerDescription::name) !=
             bench.accelerometers.end();
}

// Keys of a serial line say nothing of a TCP port.
ModbusConnection ReadConnection(YamlMap& map, const std::string& address) {
  constexpr int kMostRetries = 10;
  constexpr int kLeastBaud = 300;
  constexpr int kMostBaud = 4'000'000;
  constexpr double kLongestAnswer_s = 60.0;
  ModbusConnection connection;
  if (const auto time_s =
          map.OptionalQuantity("answer_time", schedules::Dimension::kTime, schedules::Bound::kPositive)) {
    if (*time_s < 1e-3 || *time_s > kLongestAnswer_s) {
      map.AddError("answer_time",
                   fmt::format("answer_time = {:g} s is not usable (expected 1 ms to 60 s)", *time_s));
    }
    connection.answer_time =
        std::chrono::milliseconds(std::llround(1e3 * std::clamp(*time_s, 1e-3, kLongestAnswer_s)));
  }
  if (map.has("retries")) connection.retries = map.Count("retries", 0, kMostRetries);
  const bool is_line = address.starts_with("rtu:");
  const auto of_line = [&](const char* key) {
    if (!map.has(key)) return false;
    if (!is_line) {
      (void)map.Text(key);
      map.AddError(key, fmt::format("{} belongs to a serial line (expected address: \"rtu:PATH\", or no {})",
                                    key, key));
    }
    return is_line;
  };
  if (of_line("answers_echo")) connection.answers_echo = map.Flag("answers_echo");
  if (of_line("baud")) connection.baud = map.Count("baud", kLeastBaud, kMostBaud);
  if (of_line("parity")) {
    connection.parity = map.Choice<char>("parity", {{"none", 'N'}, {"even", 'E'}, {"odd", 'O'}});
  }
  if (of_line("stop_bits")) connection.stop_bits = map.Count("stop_bits", 1, 2);
  return connection;
}

std::string AllChannels(const BenchDescription& bench) {
  std::string all;
  for (const char* name : kNeededChannels) all += fmt::format("{}, ", name);
  for (const char* name : kFurtherChannels) all += fmt::format("{}, ", name);
  for (const auto& accelerometer : bench.accelerometers) all += fmt::format("{}, ", accelerometer.name);
  return all.substr(0, all.size() - 2);
}

void CheckDrive(const BenchDescription& bench, const DriveLink& link, const std::string& servo, int line,
                ReadContext& context) {
  const auto place = context.origins.find(servo + ".drive.device");
  if (link.device.empty()) {
    context.findings.AddError(
        line, 1,
        fmt::format("{} has no drive (expected {}.drive with device, and node and profile "
                    "where the device is a CAN bus)",
                    servo, servo));
    return;
  }
  if (place == context.origins.end() || place->second.wrong) return;
  const auto error = [&](std::string message) {
    context.findings.AddError(place->second.line, place->second.column, std::move(message));
  };
  const DeviceDescription* device = FindDevice(bench.devices, link.device);
  if (device == nullptr) {
    error(fmt::format("device = {} is not among the devices (expected the name of one)", link.device));
  } else if (device->kind == Kind::kCanopen) {
    if (link.node == 0 || link.profile.empty()) {
      error(fmt::format("device = {} is a CAN bus (expected node and profile beside it)", link.device));
    }
  } else if (device->kind != Kind::kModbus) {
    error(fmt::format("device = {} drives nothing (expected one of kind canopen or modbus)", link.device));
  }
}

void CheckShunt(const BenchDescription& bench, ReadContext& context) {
  const std::string& name = bench.transducer.shunt.device;
  const DeviceDescription* const device = FindDevice(bench.devices, name);
  const auto place = context.origins.find("torque_transducer.shunt.device");
  if (name.empty() || place == context.origins.end() || place->second.wrong) return;
  if (device != nullptr && device->kind == Kind::kModbus) return;
  context.findings.AddError(
      place->second.line, place->second.column,
      fmt::format("device = {} switches nothing (expected the name of a device of kind modbus)", name));
}

}  // namespace

bool IsOnModbus(Kind kind) {
  return kind == Kind::kModbus || kind == Kind::kTorqueAmplifier || kind == Kind::kTemperatureController;
}

const DeviceDescription* FindDevice(std::span<const DeviceDescription> devices, std::string_view name) {
  const auto found = std::ranges::find(devices, name, &DeviceDescription::name);
  return found == devices.end() ? nullptr : &*found;
}

std::vector<DeviceDescription> ReadDevices(std::vector<YamlMap> maps, const std::filesystem::path& folder,
                                           ReadContext& context) {
  std::vector<DeviceDescription> devices;
  for (YamlMap& map : maps) {
    DeviceDescription device;
    device.line = map.line();
    device.name = map.Identifier("name");
    device.kind = map.Choice<Kind>("kind", {{"canopen", Kind::kCanopen},
                                            {"modbus", Kind::kModbus},
                                            {"torque_amplifier", Kind::kTorqueAmplifier},
                                            {"temperature_controller", Kind::kTemperatureController},
                                            {"stream", Kind::kStream},
                                            {"iio", Kind::kIio},
                                            {"pendant", Kind::kPendant},
                                            {"sto_contact", Kind::kStoContact},
                                            {"hid", Kind::kHid},
                                            {"camera", Kind::kCamera}});
    switch (device.kind) {
      case Kind::kCanopen:
        device.address = map.Text("interface");
        break;
      case Kind::kModbus:
      case Kind::kTorqueAmplifier:
      case Kind::kTemperatureController:
        device.address = map.Text("address");
        device.unit = map.Count("unit", 0, kMostUnits, "1");
        device.file = Below(folder, map.Text("registers"));
        device.connection = ReadConnection(map, device.address);
        if (device.kind == Kind::kTemperatureController) {
          device.set_point_degC =
              map.OptionalQuantity("set_point", schedules::Dimension::kTemperature, schedules::Bound::kAny);
        }
        break;
      case Kind::kIio:
        device.address = map.Text("address");
        device.iio_device = map.Text("device");
        break;
      case Kind::kStream:
      case Kind::kCamera:
        device.address = map.Text("address");
        break;
      case Kind::kPendant:
      case Kind::kStoContact:
      case Kind::kHid:
        device.file = Below(folder, map.Text("profile"));
        break;
    }
    map.Finish();
    if (!map.is_wrong("name") && FindDevice(devices, device.name) != nullptr) {
      const schedules::Origin& origin = context.origins[map.PathOf("name")];
      context.findings.AddError(
          origin.line, origin.column,
          fmt::format("two devices are named '{}' (expected a name of its own)", device.name));
    }
    devices.push_back(std::move(device));
  }
  return devices;
}

DriveLink ReadDriveLink(YamlMap map, const std::filesystem::path& folder) {
  DriveLink link;
  link.device = map.Text("device", "");
  link.node = map.Count("node", 0, kMostNodes, "0");
  link.profile = Below(folder, map.Text("profile", ""));
  map.Finish();
  return link;
}

std::vector<ChannelLink> ReadChannelLinks(std::vector<YamlMap> maps, ReadContext& context) {
  std::vector<ChannelLink> links;
  for (YamlMap& map : maps) {
    ChannelLink link;
    link.line = map.line();
    link.channel = map.Identifier("channel");
    link.device = map.Identifier("device");
    link.source = map.Text("source");
    map.Finish();
    const auto first = std::ranges::find(links, link.channel, &ChannelLink::channel);
    if (first != links.end() && !map.is_wrong("channel")) {
      const schedules::Origin& origin = context.origins[map.PathOf("channel")];
      context.findings.AddError(
          origin.line, origin.column,
          fmt::format("channel '{}' is there twice (expected once; it is already on line "
                      "{})",
                      link.channel, first->line));
    }
    links.push_back(std::move(link));
  }
  return links;
}

void CheckDevices(const BenchDescription& bench, int line, ReadContext& context) {
  CheckDrive(bench, bench.driving_servo.drive, "driving_servo", line, context);
  CheckDrive(bench, bench.load_servo.drive, "load_servo", line, context);
  for (std::size_t i = 0; i < bench.channels.size(); ++i) {
    const ChannelLink& link = bench.channels[i];
    const auto error = [&](const char* key, const std::string& message) {
      const schedules::Origin& origin = context.origins[fmt::format("channels[{}].{}", i, key)];
      if (!origin.wrong) context.findings.AddError(origin.line, origin.column, message);
    };
    if (!IsChannel(bench, link.channel)) {
      error("channel", fmt::format("channel = {} is not one of the bench's (expected one of {})",
                                   link.channel, AllChannels(bench)));
    }
    const DeviceDescription* device = FindDevice(bench.devices, link.device);
    if (device == nullptr) {
      error("device",
            fmt::format("device = {} is not among the devices (expected the name of one)", link.device));
    } else if (!GivesChannels(device->kind)) {
      error("device",
            fmt::format("device = {} has no channels (expected one of kind modbus, torque_amplifier, "
                        "temperature_controller, stream, iio or hid)",
                        link.device));
    } else if (IsAngle(link.channel) && !DatesItsSamples(device->kind)) {
      error("device", fmt::format("device = {} does not date its samples (expected one of kind stream or iio "
                                  "for an angle)",
                                  link.device));
    } else if (IsAccelerometer(link.channel) && !DatesItsSamples(device->kind)) {
      error("device", fmt::format("device = {} sends no samples (expected one of kind stream or iio for an "
                                  "accelerometer)",
                                  link.device));
    }
  }
  CheckShunt(bench, context);
  const auto section = context.origins.find("channels");
  const int at = section == context.origins.end() ? line : section->second.line;
  for (const char* needed : kNeededChannels) {
    if (std::ranges::find(bench.channels, needed, &ChannelLink::channel) == bench.channels.end()) {
      context.findings.AddError(
          at, 1,
          fmt::format("channels has no {} (expected {{channel: {}, device: …, source: …}})", needed, needed));
    }
  }
  for (const AccelerometerDescription& accelerometer : bench.accelerometers) {
    if (std::ranges::find(bench.channels, accelerometer.name, &ChannelLink::channel) ==
        bench.channels.end()) {
      context.findings.AddError(
          at, 1,
          fmt::format("channels has no {} (expected one for every accelerometer)", accelerometer.name));
    }
  }
}

}  // namespace strainwave::bench
