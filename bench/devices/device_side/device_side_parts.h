// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "bench/devices/device_side/device_side.h"
#include "bench/devices/device_side/drive_on_bus.h"
#include "bench/devices/device_side/servo_physics.h"
#include "daq/acquisition/sample_block.h"
#include "protocols/canopen/drive_node.h"

namespace strainwave::bench {

/// One drive on a bus, with the simulated servo as its motor.
struct DeviceSide::Drive {
  Drive(const protocols::canopen::EdsFile& eds, int number, ServoDrive& servo, const ServoUnits& units,
        CanBus& bus)
      : node_id(number),
        physics(servo, units),
        node(eds, static_cast<std::uint8_t>(number), physics),
        on_bus(bus, node) {}

  int node_id;
  ServoPhysics physics;
  protocols::canopen::device::DriveNode node;
  DriveOnBus on_bus;
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
