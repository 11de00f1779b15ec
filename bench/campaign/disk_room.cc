// SPDX-License-Identifier: Apache-2.0
#include "bench/campaign/disk_room.h"

#include <chrono>
#include <filesystem>
#include <system_error>

#include "schedules/reader/plan.h"

namespace strainwave::bench {

std::optional<DiskRoom> DiskRoomOf(const CampaignFolder& folder, const schedules::Schedule& schedule,
                                   int complete_cycles) {
  const auto plan = schedules::MakePlan(schedule, std::chrono::system_clock::now());
  std::error_code error;
  const auto space = std::filesystem::space(folder.root, error);
  if (error) return std::nullopt;
  const double left = static_cast<double>(schedule.cycles - complete_cycles) / schedule.cycles;
  return DiskRoom{static_cast<double>(space.available), static_cast<double>(plan.disk_bytes) * left};
}

std::optional<DiskRoom> LittleRoom(const CampaignFolder& folder, const schedules::Schedule& schedule,
                                   int complete_cycles) {
  const auto room = DiskRoomOf(folder, schedule, complete_cycles);
  return room && room->free_bytes < room->needed_bytes ? room : std::nullopt;
}

}  // namespace strainwave::bench
