// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstddef>
#include <deque>
#include <string>
#include <vector>

#include "bench/devices/modbus/modbus_link.h"
#include "bench/realtime/latest.h"
#include "bench/roles/bench_clock.h"
#include "bench/roles/channel_value.h"
#include "protocols/modbus/register_map.h"

namespace strainwave::bench {

/// Reads the registers of a map as often as it says, in as few requests as it allows, and keeps the newest
/// value of each with its time. A device that is too slow for its periods is asked as fast as it answers; a
/// reading that was missed is not made up for.
class ModbusPoller {
 public:
  /// @param map, clock  outlive the poller.
  ModbusPoller(const protocols::modbus::RegisterMap& map, const BenchClock& clock);

  /// When the next register is due: long ago while a request is still pending, never: the largest time.
  std::chrono::nanoseconds NextDue() const;
  /// One request of those that are due; good when none is. A refused one leaves its registers without a
  /// value.
  ModbusReply PollOne(ModbusLink& link);
  /// The same for these registers, whether due or not, now.
  ModbusReply ReadNow(ModbusLink& link, std::span<const std::size_t> registers);

  /// From any thread, never waits. Good while it is plausible and no older than its register allows.
  ChannelValue Value(std::size_t index) const noexcept;

  /// What the last request asked for: "holding 10 to 13 (speed, torque)".
  const std::string& last_asked() const { return last_asked_; }

 private:
  ModbusReply Read(ModbusLink& link, const protocols::modbus::ReadRequest& request);
  void PlanWhatIsDue(std::chrono::nanoseconds now);

  const protocols::modbus::RegisterMap& map_;
  const BenchClock& clock_;
  std::vector<std::chrono::nanoseconds> due_;  // a register
  std::deque<protocols::modbus::ReadRequest> pending_;
  std::deque<Latest<ChannelValue>> values_;  // a register
  std::string last_asked_;
};

}  // namespace strainwave::bench
