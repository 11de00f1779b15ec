// SPDX-License-Identifier: Apache-2.0
#include "bench/campaign/disk_room.h"

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <system_error>

#include <fmt/core.h>

#include "schedules/reader/plan.h"

namespace strainwave::bench {
namespace {

constexpr int kNewest = 10;

// 0: there is none.
double LargestOfNewest_bytes(const CampaignFolder& folder, int complete_cycles) {
  std::uintmax_t largest = 0;
  for (int cycle = std::max(1, complete_cycles - kNewest + 1); cycle <= complete_cycles; ++cycle) {
    std::error_code none;
    const auto bytes = std::filesystem::file_size(folder.CycleFile(cycle), none);
    if (!none) largest = std::max(largest, bytes);
  }
  return static_cast<double>(largest);
}

}  // namespace

double DiskRoom::Lasts_s(double cycle_s) const {
  const double room_bytes = std::max(0.0, free_bytes - kReserve_bytes);
  return cycle_bytes > 0.0 ? room_bytes / cycle_bytes * cycle_s : std::numeric_limits<double>::infinity();
}

std::string BytesText(double bytes) {
  if (bytes >= 1e9) return fmt::format("{:.2f} GB", bytes * 1e-9);
  if (bytes >= 1e6) return fmt::format("{:.1f} MB", bytes * 1e-6);
  return fmt::format("{:.1f} kB", bytes * 1e-3);
}

double PlannedCycle_bytes(const schedules::Schedule& schedule) {
  const auto plan = schedules::MakePlan(schedule, std::chrono::system_clock::now());
  return static_cast<double>(plan.disk_bytes) / std::max(1, schedule.cycles);
}

std::optional<DiskRoom> DiskRoomOf(const CampaignFolder& folder, double planned_cycle_bytes,
                                   int complete_cycles, int cycles) {
  std::error_code error;
  const auto space = std::filesystem::space(folder.root, error);
  if (error) return std::nullopt;
  const double stored_bytes = LargestOfNewest_bytes(folder, complete_cycles);
  const bool by_plan = stored_bytes == 0.0 || std::filesystem::exists(folder.Streams(), error);
  DiskRoom room;
  room.free_bytes = static_cast<double>(space.available);
  room.cycle_bytes = by_plan ? std::max(planned_cycle_bytes, stored_bytes) : stored_bytes;
  room.record_bytes = stored_bytes == 0.0 ? planned_cycle_bytes : stored_bytes;
  room.needed_bytes = room.cycle_bytes * std::max(0, cycles - complete_cycles);
  return room;
}

}  // namespace strainwave::bench
