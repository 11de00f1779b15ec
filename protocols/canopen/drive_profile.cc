// SPDX-License-Identifier: Apache-2.0
#include "protocols/canopen/drive_profile.h"

#include <algorithm>

#include "protocols/canopen/drive_image.h"

namespace strainwave::protocols::canopen {

bool IsAbsent(const DriveProfile& profile, std::uint16_t index) noexcept {
  const std::vector<std::uint16_t>& absent = profile.quirks.absent_objects;
  return std::find(absent.begin(), absent.end(), index) != absent.end();
}

std::vector<PdoSetting> StandardPdos(const DriveProfile& profile) {
  constexpr std::uint8_t kEverySync = 1;
  constexpr std::uint8_t kByEvent = 255;
  const auto to_drive = [](std::uint16_t number, std::uint32_t cob_id, std::uint8_t type,
                           std::vector<PdoEntry> entries) {
    return PdoSetting{PdoFlow::kToDrive, number, cob_id, type, {}, {}, std::move(entries)};
  };
  const auto from_drive = [](std::uint16_t number, std::uint32_t cob_id, std::uint8_t type,
                             std::vector<PdoEntry> entries) {
    return PdoSetting{PdoFlow::kFromDrive, number, cob_id, type, {}, {}, std::move(entries)};
  };

  std::vector<PdoSetting> pdos;
  pdos.push_back(to_drive(1, 0x200, kByEvent, {{kControlwordObject, 16}, {kModeObject, 8}}));
  if (!profile.quirks.lacks_rpdo_event_timer) {
    pdos.back().event_timer_ms = profile.supervision.rpdo_event_timer_ms;
  }
  pdos.push_back(to_drive(2, 0x300, kEverySync, {{kTargetPositionObject, 32}, {kTargetVelocityObject, 32}}));
  pdos.push_back(to_drive(3, 0x400, kEverySync, {{kTargetTorqueObject, 16}}));
  if (profile.brake.by == BrakeControl::By::kDigitalOutput) {
    pdos.back().entries.push_back({kDigitalOutputsObject, 32});
    pdos.back().transmission_type = kByEvent;  // the brake does not wait for SYNC
  }

  pdos.push_back(from_drive(1, 0x180, kByEvent, {{kStatuswordObject, 16}, {kModeDisplayObject, 8}}));
  if (!IsAbsent(profile, kErrorCodeObject.index)) pdos.back().entries.push_back({kErrorCodeObject, 16});
  if (profile.quirks.lacks_tpdo_event_timer) {
    pdos.back().transmission_type = kEverySync;
  } else {
    const auto period_ms =
        std::chrono::duration_cast<std::chrono::milliseconds>(profile.timing.sync_period).count();
    pdos.back().event_timer_ms =
        static_cast<std::uint16_t>(std::clamp<std::int64_t>(2 * period_ms, 1, 0xFFFF));
  }
  pdos.push_back(
      from_drive(2, 0x280, kEverySync, {{kPositionActualObject, 32}, {kVelocityActualObject, 32}}));
  pdos.push_back(from_drive(3, 0x380, kEverySync, {{kTorqueActualObject, 16}}));
  if (profile.safe_torque_off.from == BitSource::From::kDigitalInputs ||
      profile.brake.engaged_feedback.from == BitSource::From::kDigitalInputs) {
    pdos.back().entries.push_back({kDigitalInputsObject, 32});
  }
  return pdos;
}

std::vector<PdoSetting> PdosOf(const DriveProfile& profile, std::uint8_t node_id) {
  std::vector<PdoSetting> pdos = profile.pdos.empty() ? StandardPdos(profile) : profile.pdos;
  for (PdoSetting& pdo : pdos) pdo.cob_id += node_id;
  return pdos;
}

}  // namespace strainwave::protocols::canopen
