// SPDX-License-Identifier: Apache-2.0
#include "bench/campaign/disk_room.h"

#include <chrono>
#include <filesystem>
#include <system_error>

#include "schedules/reader/plan.h"

namespace strainwave::bench {

double NeededRoom_bytes(const schedules::Schedule& schedule, int complete_cycles) {
  const auto plan = schedules::MakePlan(schedule, std::chrono::system_clock::now());
  return static_cast<double>(plan.disk_bytes) * static_cast<double>(schedule.cycles - complete_cycles) /
         schedule.cycles;
}

std::optional<DiskRoom> DiskRoomOf(const CampaignFolder& folder, double needed_bytes) {
  std::error_code error;
  const auto space = std::filesystem::space(folder.root, error);
  if (error) return std::nullopt;
  return DiskRoom{static_cast<double>(space.available), needed_bytes};
}

std::optional<DiskRoom> LittleRoom(const CampaignFolder& folder, const schedules::Schedule& schedule,
                                   int complete_cycles) {
  const auto room = DiskRoomOf(folder, NeededRoom_bytes(schedule, complete_cycles));
  return room && IsLittle(*room) ? room : std::nullopt;
}

}  // namespace strainwave::bench
