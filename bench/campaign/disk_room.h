// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "bench/campaign/folder.h"
#include "schedules/reader/schedule.h"

namespace strainwave::bench {

struct DiskRoom {
  double free_bytes{};
  double needed_bytes{};
};

constexpr bool IsLittle(const DiskRoom& room) { return room.free_bytes < room.needed_bytes; }

/// By the raw data of the cycles to come, uncompressed.
double NeededRoom_bytes(const schedules::Schedule& schedule, int complete_cycles);

/// Nothing where the disk does not say how much room it has.
std::optional<DiskRoom> DiskRoomOf(const CampaignFolder& folder, double needed_bytes);

/// Nothing where the disk has room enough, or does not say how much it has.
std::optional<DiskRoom> LittleRoom(const CampaignFolder& folder, const schedules::Schedule& schedule,
                                   int complete_cycles);

}  // namespace strainwave::bench
