// SPDX-License-Identifier: Apache-2.0
#include "bench/machines/device_side/played_bench.h"

#include "bench/machines/plant_model_of.h"
#include "bench/realtime/realtime.h"

namespace strainwave::bench {

PlayedBench::PlayedBench(const BenchDescription& bench, double ratio, const BenchClock& clock) {
  constexpr std::size_t kOfTheListener = 8192;  // frames: about a second, should its thread be held up
  // As txqueuelen 1000 of an interface: a wire that this program plays is held up as its threads are, for
  // which heartbeats and the age of readings say how long it may be. A stop purges the queue.
  constexpr std::size_t kTransmitFrames = 1000;
  DeviceSideBuses ends;
  bool is_played = false;
  for (const DeviceDescription& device : bench.devices) {
    if (!IsInProcess(device)) continue;
    is_played = true;
    if (device.kind != DeviceDescription::Kind::kCanopen) continue;
    auto& bus = buses_[device.name];
    bus = std::make_unique<InProcessCanBus>(InProcessCanSettings{
        .ends = 4, .transmit_frames = kTransmitFrames, .receive_frames = kOfTheListener});
    ends[device.name] = {&bus->end(1), &bus->end(2)};
  }
  if (!is_played) return;
  devices_ = std::make_unique<DeviceSide>(bench, PlantModelOf(bench, ratio), ends);
  thread_ = std::thread([this, &clock] {
    (void)BecomeRealtime(RealtimeRank::kDeviceSide);
    RunInRealTime(*devices_, clock, ending_, [this, &clock] {
      for (auto& [name, bus] : buses_) bus->Exchange(clock.Now());
    });
  });
}

PlayedBench::~PlayedBench() {
  ending_ = true;
  if (thread_.joinable()) thread_.join();
}

CanBus* PlayedBench::EndOf(const std::string& device, int end) {
  const auto found = buses_.find(device);
  return found == buses_.end() ? nullptr : &found->second->end(end);
}

std::string PlayedBench::AddressOf(const DeviceDescription& device) const {
  const std::string played = devices_ ? devices_->AddressOf(device.name) : "";
  return played.empty() ? device.address : played;
}

}  // namespace strainwave::bench
