// SPDX-License-Identifier: Apache-2.0
// The logs of a bench's CAN buses, and what goes wrong on them.
#include <fmt/format.h>

#include "bench/devices/can/socket_can_bus.h"
#include "bench/devices/canopen/bus_troubles.h"
#include "bench/machines/field/field_machine.h"

namespace strainwave::bench {

SocketCanSettings FieldMachine::SocketCanOf(const DeviceDescription& device) const {
  SocketCanSettings settings;
  settings.interface = device.address;
  settings.clock_zero = -clock_.FromKernel({});
  return settings;
}

void FieldMachine::LogBuses(const std::filesystem::path& folder) {
  constexpr int kRoom = 8'000'000;  // bytes in the kernel: some seconds of a full bus
  for (auto& [name, bus] : buses_) {
    CanBus* listener = played_->Listener(name);
    if (listener == nullptr) {
      SocketCanSettings settings = SocketCanOf(Named(name));  // no filters: all is logged
      settings.receive_bytes = kRoom;
      bus.listener = std::make_unique<SocketCanBus>(settings);
      listener = bus.listener.get();
    }
    bus.log = std::make_unique<CandumpLog>(
        *listener, clock_, CandumpLogSettings{.folder = folder, .interface = Named(name).address});
  }
}

void FieldMachine::KeepBusLogs(const std::filesystem::path& stem) {
  for (const auto& [name, bus] : buses_) {
    if (bus.log) bus.log->Keep(stem);
  }
}

void FieldMachine::NoteBusTroubles(std::vector<std::string>& notes) {
  for (auto& [name, bus] : buses_) {
    if (!bus.served) continue;
    const DriveBusCounts counts = bus.served->counts();
    for (const std::string& trouble : BusTroubles(counts, bus.told)) {
      notes.push_back(fmt::format("{}: {}", name, trouble));
    }
    bus.told = counts;
  }
}

// Point 8 of what is asked of a master: the jitter of SYNC is logged.
void FieldMachine::NoteSyncs(std::vector<std::string>& notes) {
  const auto ms = [](std::chrono::nanoseconds time) {
    return std::chrono::duration<double, std::milli>(time).count();
  };
  for (auto& [name, bus] : buses_) {
    if (!bus.served) continue;
    const protocols::canopen::SyncIntervals syncs = bus.served->TakeSyncIntervals();
    if (syncs.count == 0) continue;
    notes.push_back(fmt::format(
        "{}: {} SYNCs, {:.3f} ms apart (mean; from {:.3f} to {:.3f} ms; {:.3f} ms asked for)", name,
        syncs.count, ms(syncs.mean), ms(syncs.min), ms(syncs.max), ms(bus.served->sync_period())));
  }
}

void FieldMachine::NoteBusLogs(std::vector<std::string>& notes) {
  for (auto& [name, bus] : buses_) {
    if (!bus.log || bus.log->lost() == bus.lost_in_log) continue;
    const std::string trouble = bus.log->trouble();
    notes.push_back(fmt::format("{} more frames of {} are not in its log{}{}",
                                bus.log->lost() - bus.lost_in_log, Named(name).address,
                                trouble.empty() ? "" : ": ", trouble));
    bus.lost_in_log = bus.log->lost();
  }
}

}  // namespace strainwave::bench
