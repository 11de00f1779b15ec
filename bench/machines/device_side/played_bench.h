// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <map>
#include <memory>
#include <string>
#include <thread>

#include "bench/configuration/bench_description.h"
#include "bench/devices/can/in_process_can_bus.h"
#include "bench/machines/device_side/device_side.h"
#include "bench/roles/bench_clock.h"

namespace strainwave::bench {

/// The device side within this program, on a thread and in real time: where a bench file has a device that is
/// in process, it stands in for the whole bench.
class PlayedBench {
 public:
  /// Nothing is played where no device is in process.
  /// @param ratio  of the gear.
  /// @param clock  outlives the bench.
  /// @throws as DeviceSide.
  PlayedBench(const BenchDescription& bench, double ratio, const BenchClock& clock);
  PlayedBench(const PlayedBench&) = delete;
  PlayedBench& operator=(const PlayedBench&) = delete;
  ~PlayedBench();

  /// The master's end of a CAN device, and one that only listens; null where the bus is not played.
  CanBus* Bus(const std::string& device) { return EndOf(device, 0); }
  CanBus* Listener(const std::string& device) { return EndOf(device, 3); }
  /// Null where nothing is played.
  DeviceSide* devices() noexcept { return devices_.get(); }
  /// Where a device of the file is to be found.
  std::string AddressOf(const DeviceDescription& device) const;

 private:
  CanBus* EndOf(const std::string& device, int end);

  std::map<std::string, std::unique_ptr<InProcessCanBus>> buses_;
  std::unique_ptr<DeviceSide> devices_;
  std::atomic<bool> ending_{};
  std::thread thread_;
};

}  // namespace strainwave::bench
