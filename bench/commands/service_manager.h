// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "bench/campaign/progress.h"

namespace strainwave::bench {

/// The service manager (systemd) that has started this process: sd_notify(3). Where none has, nothing
/// happens.
class ServiceManager {
 public:
  ServiceManager();

  /// The campaign runs: from now on the manager's `WatchdogSec` counts.
  void Ready() const;
  /// The control loop and the campaign go on. To be called as often as there is something new; sent four
  /// times in each `WatchdogSec`.
  void Alive();
  /// A line for `systemctl status`.
  void Status(std::string_view words) const;

 private:
  std::optional<std::chrono::microseconds> watchdog_;  // WatchdogSec; nothing: there is none
  std::chrono::steady_clock::time_point last_{};
};

/// Whether the machine's service manager is bringing it down (power-off, reboot, halt), as it says on the
/// system's bus. False where nothing answers there, so that a stop counts as a person's.
bool MachineGoesDown() noexcept;

/// Progress of a campaign for people and for the service manager, whose watchdog hears each `Update`. Those
/// come when the control loop has gone on: of a loop, or a campaign, that hangs it hears nothing.
class ServiceProgress final : public ProgressSink {
 public:
  ServiceProgress(ProgressSink& people, ServiceManager& manager) : people_(people), manager_(manager) {}
  void Update(const ProgressState& state) override;
  void Message(std::string_view severity, std::string_view text) override;
  void CycleStored(int cycle, const std::vector<Result>& results) override;

 private:
  ProgressSink& people_;
  ServiceManager& manager_;
  std::string status_;
};

}  // namespace strainwave::bench
