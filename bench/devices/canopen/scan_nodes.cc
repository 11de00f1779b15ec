// SPDX-License-Identifier: Apache-2.0
#include "bench/devices/canopen/scan_nodes.h"

#include <chrono>
#include <optional>

namespace strainwave::bench {

using protocols::CanFrame;
using protocols::canopen::FoundNode;
using protocols::canopen::NodeScan;

std::vector<FoundNode> ScanNodes(CanBus& bus, BenchClock& clock, NodeScan& scan, std::string& note) {
  constexpr std::chrono::milliseconds kLook{1};
  std::optional<CanFrame> waiting;  // for the bus to take it
  scan.Start(clock.Now());
  while (!scan.IsDone(clock.Now()) && bus.state() != CanState::kBusOff) {
    ReceivedFrame received;
    while (bus.Receive(received)) scan.OnFrame(received.frame, clock.Now());
    if (!waiting) waiting = scan.NextFrame(clock.Now());
    while (waiting && bus.Send(*waiting) == CanBus::Sent::kQueued) waiting = scan.NextFrame(clock.Now());
    clock.SleepUntil(clock.Now() + kLook);
  }
  bus.PurgeTransmit();
  if (bus.state() == CanState::kBusOff) {
    note = "is bus-off (check bitrate, wiring and both terminating resistors; then set it down and up)";
  } else if (waiting) {
    note =
        "does not get rid of its frames: nobody else on the bus hears them (check that the devices are on, "
        "bitrate, wiring and both terminating resistors)";
  } else if (scan.has_other_master()) {
    note = "is in use: another program sends SYNC or NMT commands on it";
  }
  return scan.Nodes();
}

}  // namespace strainwave::bench
