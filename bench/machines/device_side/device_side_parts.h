// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "bench/machines/device_side/device_side.h"
#include "bench/machines/device_side/drive_on_bus.h"
#include "bench/machines/device_side/limited_servo.h"
#include "bench/machines/device_side/modbus_servo_model.h"
#include "bench/machines/device_side/servo_physics.h"
#include "daq/acquisition/sample_block.h"
#include "protocols/canopen/drive_node.h"

namespace strainwave::bench {

/// A drive's software on a CAN bus, with its motor.
struct PlayedCanopenDrive {
  PlayedCanopenDrive(const protocols::canopen::EdsFile& eds, int node_id, ServoDrive& servo,
                     const ServoUnits& units, CanBus& bus)
      : physics(servo, units), node(eds, static_cast<std::uint8_t>(node_id), physics), on_bus(bus, node) {}

  ServoPhysics physics;
  protocols::canopen::device::DriveNode node;
  DriveOnBus on_bus;
};

/// One drive, by the name that commands call it by, with a simulated servo as its motor. It has one of the
/// two.
struct DeviceSide::Drive {
  Drive(std::string name_of_drive, ServoDrive& simulated, double ratio)
      : name(std::move(name_of_drive)), servo(simulated), reducer_ratio(ratio) {}

  std::string name;  // its node, or its Modbus device
  LimitedServo servo;
  double reducer_ratio;  // motor over servo
  std::unique_ptr<PlayedCanopenDrive> canopen;
  std::unique_ptr<ModbusServoModel> modbus;
};

/// One stream of samples, and where each of its channels comes from.
struct DeviceSide::Stream {
  std::string device;
  std::vector<std::string> channels;  // of the bench, in the order of the stream's own
  bool is_vibration{};
  std::unique_ptr<StreamServer> server;
  daq::acquisition::SampleBlock block;
  std::uint64_t counter{};
};

}  // namespace strainwave::bench
