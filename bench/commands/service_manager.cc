// SPDX-License-Identifier: Apache-2.0
#include "bench/commands/service_manager.h"

#include <fmt/core.h>
#include <systemd/sd-daemon.h>

namespace strainwave::bench {

ServiceManager::ServiceManager() {
  std::uint64_t watchdog_us = 0;
  if (::sd_watchdog_enabled(0, &watchdog_us) > 0) watchdog_ = std::chrono::microseconds(watchdog_us);
}

void ServiceManager::Ready() const { ::sd_notify(0, "READY=1"); }

void ServiceManager::Alive() {
  const auto now = std::chrono::steady_clock::now();
  if (!watchdog_ || now - last_ < *watchdog_ / 4) return;
  last_ = now;
  ::sd_notify(0, "WATCHDOG=1");
}

void ServiceManager::Status(std::string_view words) const {
  ::sd_notify(0, fmt::format("STATUS={}", words.substr(0, words.find('\n'))).c_str());
}

void ServiceProgress::Update(const ProgressState& state) {
  people_.Update(state);
  manager_.Alive();
  const std::string status = fmt::format("{:.0f} %, cycle {} of {}, {}", 100.0 * state.share, state.cycle,
                                         state.cycles, state.phase);
  if (status == status_) return;
  status_ = status;
  manager_.Status(status);
}

void ServiceProgress::Message(std::string_view severity, std::string_view text) {
  people_.Message(severity, text);
}

void ServiceProgress::CycleStored(int cycle, const std::vector<Result>& results) {
  people_.CycleStored(cycle, results);
  manager_.Alive();
}

}  // namespace strainwave::bench
