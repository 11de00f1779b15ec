// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <vector>

#include "bench/devices/can/device_clock.h"
#include "bench/roles/can_bus.h"

namespace strainwave::bench {

/// Frames whose id agrees with `id` where `mask` has ones.
struct CanFilter {
  std::uint32_t id{};
  std::uint32_t mask{};
  bool extended{};
};

/// What concerns a node: NMT, SYNC, everybody's sign of life, and what bears its number (CiA 301, 7.3.3).
std::vector<CanFilter> FiltersOfNode(int node);

struct SocketCanSettings {
  std::string interface;  // "can0"
  /// What the kernel lets through; empty: all. Ids that are sent pass, too, from their first time on.
  std::vector<CanFilter> filters{};
  /// Frames that the kernel holds at most, and the queue in front of it, which alone can be purged.
  std::size_t most_in_flight{6};
  std::size_t transmit_frames{32};
  /// What the kernel may hold on the way in; 0: as much as it does by itself, some hundred frames. More than
  /// net.core.rmem_max only for root.
  int receive_bytes{};
  /// Where `BenchClock` is zero on CLOCK_MONOTONIC.
  std::chrono::nanoseconds clock_zero{};
};

/// A CAN interface of Linux through a raw socket: kernel filters, error frames, time stamps of the interface
/// where it has them (else the kernel's), losses as the kernel counts them.
///
/// A stop. What the kernel has taken cannot be called back by a program: a frame lies in the controller until
/// it is acknowledged, and on a bus without a partner it goes out when the plug is put back. So few frames
/// are given to the kernel at a time: the next goes when an earlier one comes back as sent
/// (CAN_RAW_RECV_OWN_MSGS, looked at in `Send` and `Receive`). `PurgeTransmit` empties all that waits here.
/// Up to `most_in_flight` frames can still go out: on a working bus within their wire time, on a dead one
/// when it comes back. Against those: drives that watch the master (1016h, 1400h:5), and an operator who sets
/// the interface down and up, which empties it. With restart-ms 0, as it is by default, bus-off needs that
/// anyway.
class SocketCanBus final : public CanBus {
 public:
  /// @throws std::system_error when the kernel has no CAN, when there is no such interface, when it is down,
  ///   and when it is none of CAN, each with words on what to do; std::invalid_argument for queues of no
  ///   frame.
  explicit SocketCanBus(const SocketCanSettings& settings);
  ~SocketCanBus() override;

  Sent Send(const protocols::CanFrame& frame) noexcept override;
  bool Receive(ReceivedFrame& received) noexcept override;
  void PurgeTransmit() noexcept override { queued_ = 0; }
  CanState state() const noexcept override { return state_; }
  std::uint64_t lost_frames() const noexcept override { return lost_; }

  /// Frames that the kernel has and that have not come back as sent.
  std::size_t in_flight() const noexcept { return in_flight_; }

 private:
  enum class Written : std::uint8_t { kYes, kNotNow, kNever };

  Written Write(const protocols::CanFrame& frame) noexcept;
  void Flush() noexcept;
  bool ReadOne(ReceivedFrame& received, bool& own) noexcept;
  void TakeControl(const void* message, ReceivedFrame& received) noexcept;
  void TakeError(const protocols::CanFrame& frame) noexcept;
  void Gone() noexcept;
  bool IsUp() const noexcept;
  bool Passes(const protocols::CanFrame& frame) const noexcept;
  bool SetFilters() noexcept;

  std::string interface_;
  int socket_;
  std::chrono::nanoseconds clock_zero_;
  std::size_t most_in_flight_;
  std::vector<CanFilter> filters_;
  bool filtered_;
  std::vector<protocols::CanFrame> queue_;  // a ring
  std::size_t first_{};
  std::size_t queued_{};
  std::size_t in_flight_{};
  CanState state_{CanState::kErrorActive};
  std::uint64_t lost_{};
  std::uint32_t kernel_drops_{};
  DeviceClock device_clock_;
  // A frame that was read while a confirmation was looked for.
  ReceivedFrame kept_;
  bool keeps_{};
};

}  // namespace strainwave::bench
