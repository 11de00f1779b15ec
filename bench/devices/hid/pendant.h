// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>

#include "bench/devices/hid/hid_device.h"
#include "bench/devices/hid/pendant_state.h"
#include "bench/realtime/latest.h"
#include "protocols/hid_report.h"

namespace strainwave::bench {

/// The keys of a pendant within its reports: fields that are 1 while a key is down. A quick-stop key whose
/// contact opens has scale −1 and offset 1.
struct PendantProfile {
  HidSettings device;
  protocols::HidField quick_stop, reset, start;
  /// Within which the pendant reports even if no key moves; a silent one counts as pressed. 0: it does not.
  std::chrono::nanoseconds report_period{};
};

/// What a pendant says.
struct PendantActual {
  PendantState state{PendantState::kStopped};
  bool connected{};
  PendantKeys keys;
  std::chrono::nanoseconds time{};       // of the last report, or of its loss
  std::chrono::nanoseconds stop_time{};  // when it last went to stopped
  std::uint64_t refused_reports{};       // of a wrong length or id
};

/// An operator's pendant with a quick-stop key. It is stopped at the start, when it is unplugged, when it
/// sends what is no report of it, and when it is silent for too long; the way back is reset, then start. A
/// quick stop is not an emergency stop, which is wired.
class Pendant : private HidListener {
 public:
  /// @param clock  outlives the pendant.
  Pendant(const PendantProfile& profile, const BenchClock& clock);
  ~Pendant() override = default;

  /// From the control thread, never waits.
  PendantActual Actual() const noexcept;

 private:
  void Plugged(std::chrono::nanoseconds time) override;
  void Report(std::span<const std::uint8_t> report, std::chrono::nanoseconds time) override;
  void Unplugged(std::chrono::nanoseconds time) override;
  void Take(const PendantKeys& keys, std::chrono::nanoseconds time);

  const PendantProfile profile_;
  const BenchClock& clock_;
  PendantActual mine_;  // of the device's thread
  Latest<PendantActual> actual_;
  HidDevice device_;  // last: its thread uses all of the above
};

}  // namespace strainwave::bench
