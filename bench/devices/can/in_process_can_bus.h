// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <vector>

#include "bench/roles/can_bus.h"

namespace strainwave::bench {

struct InProcessCanSettings {
  int ends{2};
  std::uint32_t bitrate{1'000'000};  // bits a second; 0: frames take no time
  /// What one end can queue; Linux gives an interface 10.
  std::size_t transmit_frames{10};
  std::size_t receive_frames{1024};
};

/// A CAN bus between parts of one process, for benches without a CAN interface and for tests that own time.
///
/// Each end is used from one thread, `Exchange` and the faults from one thread (which may be that of an end);
/// between them are bounded queues without locks. Nothing allocates after construction. Each end sends its
/// frames in their order; among the first of each end the lowest id wins, data before a remote frame, 11 bits
/// before 29. A frame takes its bits at the bitrate and counts as received by all others at its end.
///
/// What is on the wire is past `PurgeTransmit`. An end does not hear itself. With nobody else on the bus a
/// frame stays unsent, as on a wire.
class InProcessCanBus {
 public:
  /// @throws std::invalid_argument for fewer than 2 ends or queues of no frame.
  explicit InProcessCanBus(const InProcessCanSettings& settings);
  InProcessCanBus(const InProcessCanBus&) = delete;
  InProcessCanBus& operator=(const InProcessCanBus&) = delete;
  ~InProcessCanBus();

  /// From 0. @throws std::out_of_range
  CanBus& end(int number);

  /// Carries what was queued when it is called and fits on the wire until `now`, which never steps back. A
  /// frame that was queued since the last call could start then, at the earliest.
  void Exchange(std::chrono::nanoseconds now) noexcept;

  /// A controller that gave up: it neither sends nor hears, is told so by an error frame, and what it had
  /// queued is gone.
  void SetBusOff(int number, bool off) noexcept;
  /// The next `frames` for this end are lost in its receive queue, and counted.
  void LoseNext(int number, std::uint64_t frames) noexcept;

  /// Time that frames took on the wire since the start: the bus load is its share.
  std::chrono::nanoseconds busy() const noexcept { return busy_; }
  std::uint64_t carried_frames() const noexcept { return carried_; }

 private:
  class End;

  End* Winner() noexcept;  // its frame then is on_the_wire_
  bool SomeoneHears(const End& sender) const noexcept;

  std::uint32_t bitrate_;
  std::vector<std::unique_ptr<End>> ends_;
  End* sender_{};  // of the frame on the wire; null: none is
  protocols::CanFrame on_the_wire_;
  std::chrono::nanoseconds last_exchange_{};
  std::chrono::nanoseconds free_at_{};
  std::chrono::nanoseconds busy_{};
  std::uint64_t carried_{};
};

}  // namespace strainwave::bench
