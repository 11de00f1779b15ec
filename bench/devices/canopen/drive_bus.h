// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "bench/devices/canopen/canopen_servo.h"
#include "bench/realtime/latest.h"
#include "bench/realtime/timing_histogram.h"
#include "bench/roles/bench_clock.h"
#include "bench/roles/can_bus.h"
#include "protocols/canopen/heartbeat.h"
#include "protocols/canopen/sync.h"

namespace strainwave::bench {

/// What a bus has carried, for reports.
struct DriveBusCounts {
  std::uint64_t sent{};
  std::uint64_t received{};
  std::uint64_t lost{};       // on the way in, as the interface counted them
  std::uint64_t malformed{};  // under a drive's identifiers, not as long as they must be
  CanState state{};
  CanState worst_state{};  // since the start
};

/// The drives on one CAN interface, cycle by cycle. The caller owns time: see DriveBusThread.
class DriveBus {
 public:
  /// All drives are served at the SYNC period of the first one's profile, and watch the same master.
  /// @throws std::invalid_argument for no drives, a node number taken twice, profiles that differ in SYNC
  ///   period or in the master's node number, or as CanopenServo does.
  /// @param held  asked every cycle; true keeps all drives stopped, as a pressed key does. Nothing: never.
  /// @param others_supervised  asked every cycle; false keeps every drive from being enabled, as a drive
  ///   of this bus does whose own supervision is off or unknown. Nothing: there are no others.
  DriveBus(CanBus& bus, const BenchClock& clock, std::vector<CanopenServoSettings> drives,
           std::function<bool()> held = {}, std::function<bool()> others_supervised = {});

  /// Takes in what has come, then orders, then sends: SYNC, heartbeat, and what the drives' masters have to
  /// say. Once a SYNC period.
  void Cycle(std::chrono::nanoseconds now) noexcept;
  /// Between two cycles, when somebody has called: a stop goes out at once, without waiting for the next
  /// SYNC.
  void TakeOrders(std::chrono::nanoseconds now) noexcept;

  /// Whether every drive of this bus would notice that the master is gone; from any thread.
  bool IsSupervised() const noexcept;

  std::size_t size() const noexcept { return servos_.size(); }
  CanopenServo& servo(std::size_t number) { return *servos_.at(number); }
  std::chrono::nanoseconds sync_period() const noexcept { return sync_period_; }

  /// From any thread.
  DriveBusCounts counts() const noexcept { return counts_.Get(); }
  /// Between SYNCs since the last call, as measured where they go out; from one thread of any.
  protocols::canopen::SyncIntervals TakeSyncIntervals() noexcept {
    const auto intervals = sync_intervals_.Get();
    measure_anew_.store(true);
    return intervals;
  }

 private:
  void ReceiveAll() noexcept;
  void TakeOrdersOfAll(std::chrono::nanoseconds now) noexcept;
  void SendAll(std::chrono::nanoseconds now) noexcept;
  bool Send(const protocols::CanFrame& frame, std::chrono::nanoseconds now) noexcept;
  void Publish() noexcept;

  CanBus& bus_;
  std::function<bool()> held_;
  std::function<bool()> others_supervised_;
  std::vector<std::unique_ptr<CanopenServo>> servos_;
  std::chrono::nanoseconds sync_period_{};
  protocols::canopen::SyncProducer sync_;
  protocols::canopen::HeartbeatProducer heartbeat_;
  DriveBusCounts next_counts_;
  Latest<DriveBusCounts> counts_;
  Latest<protocols::canopen::SyncIntervals> sync_intervals_;
  std::atomic<bool> measure_anew_{};
};

}  // namespace strainwave::bench
