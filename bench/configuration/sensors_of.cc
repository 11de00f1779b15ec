// SPDX-License-Identifier: Apache-2.0
#include "bench/configuration/sensors_of.h"

#include <algorithm>
#include <string_view>

#include <fmt/format.h>

namespace strainwave::bench {

BenchSensors SensorsOf(const BenchDescription& bench) {
  return {.vibration = !bench.accelerometers.empty(),
          .quick_stop_key = std::ranges::any_of(bench.devices, [](const DeviceDescription& device) {
            return device.kind == DeviceDescription::Kind::kPendant;
          })};
}

std::string SensorOf(Channel channel, const BenchDescription& bench) {
  const auto named = [](std::string_view what, const std::string& serial) {
    return serial.empty() ? std::string(what) : fmt::format("{} {}", what, serial);
  };
  const auto device_of = [&](std::string_view name, std::string_view what) {
    const auto link = std::ranges::find(bench.channels, name, &ChannelLink::channel);
    return link == bench.channels.end() ? std::string(what) : fmt::format("device {}", link->device);
  };
  switch (channel) {
    case Channel::kInputAngle:
      return named("input encoder", bench.input_encoder.serial);
    case Channel::kOutputAngle:
      return named("output encoder", bench.output_encoder.serial);
    case Channel::kOutputTorque:
      return named("torque transducer", bench.transducer.serial);
    case Channel::kInputSpeed:
    case Channel::kMotorTorque:
      return named("driving servo", bench.driving_servo.serial);
    case Channel::kGearTemperature:
      return device_of("gear_temperature", "gear thermometer");
    case Channel::kAmbientTemperature:
      return device_of("ambient_temperature", "ambient thermometer");
    case Channel::kVibrationRms: {
      std::string all = "accelerometers";
      for (const AccelerometerDescription& one : bench.accelerometers) all += " " + one.serial;
      return all;
    }
  }
  return {};
}

}  // namespace strainwave::bench
