// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <mutex>
#include <optional>
#include <vector>

#include "bench/devices/hid/hid_device.h"
#include "bench/realtime/latest.h"
#include "protocols/hid_report.h"

namespace strainwave::bench {

/// One opening of the safe-torque-off contact, for the log.
struct StoOpening {
  std::chrono::nanoseconds time{};                  // of the report
  std::optional<std::chrono::nanoseconds> latency;  // since the stop was asked for; none: nobody had
};

struct StoActual {
  bool open{true};  // torque is off by hardware
  bool good{};      // the contact is read; else nothing is known of it
  std::chrono::nanoseconds time{};
};

/// Reads the hard-wired safe-torque-off contact, which this program neither closes nor opens: an input that
/// is shown and logged with its latency.
class StoContact : private HidListener {
 public:
  /// @param contact  0 while the contact is open.
  StoContact(const HidSettings& settings, const protocols::HidField& contact, const BenchClock& clock);
  ~StoContact() override = default;

  /// A stop was asked for: by the pendant, a limit, or a person. The first of several counts until the
  /// contact has opened. Never waits.
  void Asked(std::chrono::nanoseconds time) noexcept;
  /// Never waits.
  StoActual Actual() const noexcept { return actual_.Get(); }
  /// What opened since the last call. Not for the control thread.
  std::vector<StoOpening> TakeOpenings();

 private:
  static constexpr std::int64_t kNobody = -1;

  void Plugged(std::chrono::nanoseconds) override {}
  void Report(std::span<const std::uint8_t> report, std::chrono::nanoseconds time) override;
  void Unplugged(std::chrono::nanoseconds time) override { actual_.Set({true, false, time}); }

  const protocols::HidField contact_;
  std::atomic<std::int64_t> asked_ns_{kNobody};
  Latest<StoActual> actual_;
  std::mutex mutex_;
  std::vector<StoOpening> openings_;
  HidDevice device_;  // last: its thread uses all of the above
};

}  // namespace strainwave::bench
