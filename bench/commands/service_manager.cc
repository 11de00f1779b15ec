// SPDX-License-Identifier: Apache-2.0
#include "bench/commands/service_manager.h"

#include <cstdlib>
#include <memory>
#include <string_view>

#include <fmt/core.h>
#include <systemd/sd-bus.h>
#include <systemd/sd-daemon.h>

namespace strainwave::bench {
namespace {

constexpr std::chrono::microseconds kBusAnswersWithin = std::chrono::seconds(3);

}  // namespace

bool MachineGoesDown() noexcept {
  sd_bus* opened = nullptr;
  if (::sd_bus_open_system(&opened) < 0) return false;
  const std::unique_ptr<sd_bus, decltype(&::sd_bus_close_unref)> bus(opened, &::sd_bus_close_unref);
  ::sd_bus_set_method_call_timeout(bus.get(), static_cast<std::uint64_t>(kBusAnswersWithin.count()));
  char* state = nullptr;
  if (::sd_bus_get_property_string(bus.get(), "org.freedesktop.systemd1", "/org/freedesktop/systemd1",
                                   "org.freedesktop.systemd1.Manager", "SystemState", nullptr, &state) < 0) {
    return false;
  }
  const std::unique_ptr<char, decltype(&std::free)> freed(state, &std::free);
  return std::string_view(state) == "stopping";
}

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
