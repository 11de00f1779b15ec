// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>

#include "protocols/can_frame.h"
#include "protocols/canopen/nmt.h"

namespace strainwave::protocols::canopen {

CanFrame HeartbeatFrame(std::uint8_t node_id, NmtState state) noexcept;

/// Says at a fixed period that this node lives (CiA 301, 7.2.8.3.2), by which the drives watch the master.
class HeartbeatProducer {
 public:
  /// @throws std::invalid_argument if node_id is not 1 to 127 or period is not above zero.
  HeartbeatProducer(std::uint8_t node_id, std::chrono::nanoseconds period);

  /// The heartbeat, when one is due. After a pause one is sent, not all that were missed.
  std::optional<CanFrame> Poll(std::chrono::nanoseconds now) noexcept;

 private:
  std::uint8_t node_id_;
  std::chrono::nanoseconds period_;
  std::optional<std::chrono::nanoseconds> due_;
};

enum class HeartbeatEvent : std::uint8_t {
  kBootUp,        // the node started anew; its parameters are those of its power-up
  kStateChanged,  // `state()` tells to what; also the first heartbeat
  kLost,          // none within the time-out; told once
  kReturned,      // the first one after it was lost
};

/// Watches one node's heartbeats, from `Start` on also for the first one.
class HeartbeatConsumer {
 public:
  /// @throws std::invalid_argument if node_id is not 1 to 127 or timeout is not above zero.
  HeartbeatConsumer(std::uint8_t node_id, std::chrono::nanoseconds timeout);

  void Start(std::chrono::nanoseconds now) noexcept;
  void Stop() noexcept { is_watching_ = false; }

  std::optional<HeartbeatEvent> OnFrame(const CanFrame& frame, std::chrono::nanoseconds now) noexcept;
  std::optional<HeartbeatEvent> Poll(std::chrono::nanoseconds now) noexcept;

  /// As last reported; nothing before the first heartbeat.
  std::optional<NmtState> state() const noexcept { return state_; }
  bool is_lost() const noexcept { return is_lost_; }

 private:
  std::uint8_t node_id_;
  std::chrono::nanoseconds timeout_;
  std::chrono::nanoseconds last_{};
  std::optional<NmtState> state_;
  bool is_watching_{};
  bool is_lost_{};
};

}  // namespace strainwave::protocols::canopen
