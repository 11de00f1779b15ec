// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>

#include "protocols/can_frame.h"

namespace strainwave::bench {

/// Fault confinement of the controller (ISO 11898-1), as far as it tells.
enum class CanState : std::uint8_t { kErrorActive, kErrorWarning, kErrorPassive, kBusOff, kGone };

/// A frame and when it came in, on the clock of `BenchClock`: the interface's own time stamp where it has
/// one.
struct ReceivedFrame {
  protocols::CanFrame frame;
  std::chrono::nanoseconds time{};
};

/// A CAN interface, used from one thread. No call waits, throws or allocates.
class CanBus {
 public:
  enum class Sent : std::uint8_t {
    kQueued,
    kFull,  // the transmit queue takes no more: the caller drops the frame or tries again, and says so
    kDown,  // bus-off or the interface is gone
  };

  CanBus() = default;
  CanBus(const CanBus&) = delete;
  CanBus& operator=(const CanBus&) = delete;
  virtual ~CanBus() = default;

  virtual Sent Send(const protocols::CanFrame& frame) noexcept = 0;

  /// The next frame that came in; false when there is none. Error frames come in here, too.
  virtual bool Receive(ReceivedFrame& received) noexcept = 0;

  /// Drops every frame that was queued and is not yet on the wire, so that nothing commanded before a stop
  /// fires after it.
  virtual void PurgeTransmit() noexcept = 0;

  virtual CanState state() const noexcept = 0;

  /// Frames lost on the way in since the bus was opened, as the interface or the kernel counted them.
  virtual std::uint64_t lost_frames() const noexcept = 0;
};

}  // namespace strainwave::bench
