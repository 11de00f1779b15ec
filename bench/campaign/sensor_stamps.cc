// SPDX-License-Identifier: Apache-2.0
#include "bench/campaign/sensor_stamps.h"

#include <algorithm>
#include <string>

#include "bench/campaign/calibrations.h"
#include "daq/value_bounds.h"

namespace strainwave::bench {
namespace {

struct Stamp {
  std::string serial;
  std::string calibration;
  std::string channel{};
};

Stamp StampOf(const std::string& column, const daq::RecordKind& kind, const BenchDescription& bench) {
  const Stamp driving{bench.driving_servo.serial, "drive parameters"};
  for (const AccelerometerDescription& accelerometer : bench.accelerometers) {
    if (column.starts_with(accelerometer.name + "_m_per_s2"))
      return {accelerometer.serial, accelerometer.calibration, accelerometer.name};
  }
  if (column.starts_with("output_angle"))
    return {bench.output_encoder.serial, bench.output_encoder.calibration, "output_angle"};
  if (column.starts_with("input_") || column.starts_with("position") || column.starts_with("velocity")) {
    return {bench.input_encoder.serial, bench.input_encoder.calibration, "input_angle"};
  }
  if (column.starts_with("motor_torque")) return driving;
  // The torque of a motion record is what the drive applies; the transducer's stands beside it.
  if (kind == daq::RecordKind::kMotion && column == "torque_Nm") return driving;
  if (column.find("torque") != std::string::npos)
    return {bench.transducer.serial, bench.transducer.calibration, "output_torque"};
  return {};
}

}  // namespace

void StampSensors(std::span<NamedRecord> records, const BenchDescription& bench,
                  std::span<const ChannelCalibration> of_devices) {
  const auto troubles = CalibrationTroubles(CalibrationsOf(bench), of_devices, Today());
  for (NamedRecord& named : records) {
    for (daq::Column& column : named.record.columns) {
      Stamp stamp = StampOf(column.name, named.record.kind, bench);
      if (stamp.serial.empty()) continue;
      column.sensor_serial = std::move(stamp.serial);
      column.calibration = stamp.calibration.empty() ? "none" : std::move(stamp.calibration);
      const auto trouble = std::ranges::find(troubles, stamp.channel, &CalibrationTrouble::channel);
      if (trouble != troubles.end()) column.calibration += "; not valid: " + trouble->words;
      const auto device = std::ranges::find(of_devices, stamp.channel, &ChannelCalibration::channel);
      if (device != of_devices.end() && device->unit == daq::UnitOf(column.name)) {
        column.calibration_terms = AttributesOf(device->calibration);
      }
    }
  }
}

}  // namespace strainwave::bench
