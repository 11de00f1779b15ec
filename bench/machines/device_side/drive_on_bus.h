// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>

#include "bench/roles/can_bus.h"
#include "protocols/canopen/drive_node.h"

namespace strainwave::bench {

/// Carries frames between a bus and a drive that somebody plays on it, once a cycle. Both must outlive it.
class DriveOnBus {
 public:
  DriveOnBus(CanBus& bus, protocols::canopen::device::DriveNode& node) : bus_(bus), node_(node) {}

  /// All frames that came in, one cycle of the drive, and its frames as far as the bus takes them; one that
  /// it does not take goes first the next time.
  void Cycle(std::chrono::nanoseconds now) noexcept;
  /// Its two ends alone, for who polls the drive in between.
  void TakeFrames(std::chrono::nanoseconds now) noexcept;
  void GiveFrames() noexcept;

  /// Carried since the start.
  std::uint64_t received() const { return received_; }
  std::uint64_t sent() const { return sent_; }

 private:
  CanBus& bus_;
  protocols::canopen::device::DriveNode& node_;
  protocols::CanFrame waiting_;
  bool waits_{};
  std::uint64_t received_{};
  std::uint64_t sent_{};
};

}  // namespace strainwave::bench
