// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "bench/campaign/folder.h"
#include "schedules/reader/schedule.h"

namespace strainwave::bench {

/// How much room the disk has, and what becomes of it.
struct DiskRoom {
  double free_bytes{};
  double cycle_bytes{};   // that a cycle may take
  double record_bytes{};  // that the file of its records may take
  double needed_bytes{};  // by the cycles to come

  /// Until it is full but for the reserve, at so many seconds a cycle.
  double Lasts_s(double cycle_s) const;
};

/// What the journal may take until a cycle is stored: SQLite lets its log grow to 1000 pages of 4 KiB before
/// it takes it over, and checkpoint, readings and the lines of an end come on top.
inline constexpr double kReserve_bytes = 8.0 * 1024 * 1024;

/// Whether the campaign will not fit.
constexpr bool IsLittle(const DiskRoom& room) { return room.free_bytes < room.needed_bytes; }
/// What a cycle needs to be stored: its file is written while the records of its phases are still there. The
/// same, when a phase is ended before its time, holds what it has recorded.
constexpr double Storing_bytes(const DiskRoom& room) { return room.record_bytes + kReserve_bytes; }
/// Whether no further cycle should begin.
constexpr bool IsTooLittle(const DiskRoom& room) {
  return room.free_bytes < room.cycle_bytes + Storing_bytes(room);
}
/// Whether the cycle under way cannot be stored, and must end while that can still be written down.
constexpr bool IsTooLittleToStore(const DiskRoom& room) { return room.free_bytes < Storing_bytes(room); }

/// "7.0 MB".
std::string BytesText(double bytes);

/// Raw data of one cycle as planned, uncompressed.
double PlannedCycle_bytes(const schedules::Schedule& schedule);

/// By the largest of the newest ten cycles' files, as they are on the disk; before the first one, and where
/// raw streams are kept beside them, by the plan.
/// @return nothing where the disk does not say how much room it has.
std::optional<DiskRoom> DiskRoomOf(const CampaignFolder& folder, double planned_cycle_bytes,
                                   int complete_cycles, int cycles);

}  // namespace strainwave::bench
