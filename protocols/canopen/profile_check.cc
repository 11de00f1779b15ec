// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>

#include "protocols/canopen/drive_image.h"
#include "protocols/canopen/drive_profile.h"
#include "protocols/canopen/sdo_client.h"
#include "protocols/canopen/type_limits.h"

namespace strainwave::protocols::canopen {
namespace {

using Findings = std::vector<std::string>;

void CheckAboveZero(std::string_view name, double value, Findings& findings) {
  if (!(value > 0.0) || !std::isfinite(value)) {
    findings.push_back(fmt::format("{} = {} is not above zero", name, value));
  }
}

void CheckNumbers(const DriveProfile& profile, Findings& findings) {
  const DriveUnits& units = profile.units;
  CheckAboveZero("position_counts_per_rev", units.position_counts_per_rev, findings);
  CheckAboveZero("velocity_units_per_rpm", units.velocity_units_per_rpm, findings);
  CheckAboveZero("acceleration_units_per_rpm_per_s", units.acceleration_units_per_rpm_per_s, findings);
  CheckAboveZero("rated_torque_Nm", units.rated_torque_Nm, findings);
  CheckAboveZero("gear_ratio", units.gear_ratio, findings);
  if (units.sign != 1 && units.sign != -1) {
    findings.push_back(fmt::format("sign = {} is neither 1 nor -1", units.sign));
  }
  const DriveLimits& limits = profile.limits;
  CheckAboveZero("max_speed_rad_per_s", limits.max_speed_rad_per_s, findings);
  CheckAboveZero("max_torque_Nm", limits.max_torque_Nm, findings);
  CheckAboveZero("acceleration_rad_per_s2", limits.acceleration_rad_per_s2, findings);
  CheckAboveZero("quick_stop_deceleration_rad_per_s2", limits.quick_stop_deceleration_rad_per_s2, findings);
  CheckAboveZero("following_error_window_rad", limits.following_error_window_rad, findings);
  CheckAboveZero("standstill_speed_rad_per_s", limits.standstill_speed_rad_per_s, findings);
  if (profile.timing.sync_period <= std::chrono::nanoseconds::zero()) {
    findings.push_back(
        fmt::format("sync_period = {} ns is not above zero", profile.timing.sync_period.count()));
  }
  // Below bit 11 the controlword is the standard's.
  if (profile.brake.by == BrakeControl::By::kControlword &&
      (profile.brake.mask == 0 || (profile.brake.mask & ~0xF800U) != 0)) {
    findings.push_back(
        fmt::format("brake mask {:X}h is not of bits 11 to 15 of the controlword", profile.brake.mask));
  }
  if (profile.brake.by == BrakeControl::By::kDigitalOutput && profile.brake.mask == 0) {
    findings.emplace_back("brake mask 0 names no digital output");
  }
  if (profile.modes.empty()) findings.emplace_back("modes: the profile names none");
}

void CheckSupervision(const DriveProfile& profile, Findings& findings) {
  const Supervision& supervision = profile.supervision;
  const auto expect = [&findings](bool holds, std::string_view what) {
    if (!holds) findings.emplace_back(what);
  };
  expect(supervision.master_node_id >= 1 && supervision.master_node_id <= 127,
         "master_node_id is not 1 to 127");
  expect(supervision.drive_heartbeat_ms > 0, "drive_heartbeat_ms = 0 switches the drive's heartbeat off");
  expect(supervision.master_heartbeat_ms > 0, "master_heartbeat_ms = 0 switches the master's heartbeat off");
  expect(supervision.drive_timeout_ms > supervision.drive_heartbeat_ms,
         "drive_timeout_ms is not above drive_heartbeat_ms");
  expect(supervision.master_timeout_ms > supervision.master_heartbeat_ms,
         "master_timeout_ms is not above master_heartbeat_ms");
  expect(supervision.rpdo_event_timer_ms > 0, "rpdo_event_timer_ms = 0 lets missing set-points go unnoticed");
  const bool has_abort_option = !IsAbsent(profile, 0x6007) && profile.option_codes.abort_connection != 0;
  const bool has_behaviour = !IsAbsent(profile, 0x1029) && supervision.communication_error_behaviour != 1;
  expect(has_abort_option || has_behaviour,
         "neither abort_connection (6007h) nor communication_error_behaviour (1029h:01) stops the drive when "
         "the master is gone");
  expect(!IsAbsent(profile, 0x1016) && !IsAbsent(profile, 0x1017),
         "a drive without heartbeats (1016h, 1017h) cannot be watched");
}

bool Maps(const std::vector<PdoSetting>& pdos, PdoFlow flow, ObjectAddress address) {
  return std::any_of(pdos.begin(), pdos.end(), [&](const PdoSetting& pdo) {
    return pdo.flow == flow && std::any_of(pdo.entries.begin(), pdo.entries.end(),
                                           [&](const PdoEntry& e) { return e.address == address; });
  });
}

void CheckPdos(const DriveProfile& profile, Findings& findings) {
  const std::vector<PdoSetting> pdos = PdosOf(profile, 1);
  constexpr std::size_t kMostPdos = 16;
  if (pdos.size() > kMostPdos) {
    findings.push_back(fmt::format("pdos = {} are more than {}", pdos.size(), kMostPdos));
  }
  std::set<std::uint32_t> cob_ids;
  const auto borne = profile.timing.stale_after_syncs * profile.timing.sync_period;
  for (const PdoSetting& pdo : pdos) {
    if (pdo.flow == PdoFlow::kFromDrive && pdo.transmission_type > 240 &&
        std::chrono::milliseconds(pdo.event_timer_ms.value_or(0xFFFF)) >= borne) {
      findings.push_back(fmt::format("PDO {:X}h may come later than stale_after_syncs = {} bears",
                                     pdo.cob_id - 1, profile.timing.stale_after_syncs));
    }
    try {
      (void)RemapWrites(pdo);
    } catch (const std::invalid_argument& error) {
      findings.emplace_back(error.what());
    }
    if (!cob_ids.insert(pdo.cob_id).second) {
      findings.push_back(fmt::format("two PDOs share the COB-ID {:X}h", pdo.cob_id - 1));
    }
    for (const PdoEntry& entry : pdo.entries) {
      const std::optional<std::uint8_t> bits = ImageBits(pdo.flow, entry.address);
      const std::string where = fmt::format("PDO {:X}h maps {}", pdo.cob_id - 1, Words(entry.address));
      if (!bits && pdo.flow == PdoFlow::kToDrive) {
        findings.push_back(where + ", for which the master has no value");
      } else if (bits && *bits != entry.bits) {
        findings.push_back(fmt::format("{} with {} bits, it has {}", where, entry.bits, *bits));
      }
    }
  }
  const auto expect = [&](PdoFlow flow, ObjectAddress address, std::string_view name) {
    if (!Maps(pdos, flow, address)) {
      findings.push_back(fmt::format("no PDO maps {} ({})", Words(address), name));
    }
  };
  expect(PdoFlow::kToDrive, kControlwordObject, "controlword");
  expect(PdoFlow::kToDrive, kModeObject, "mode of operation");
  expect(PdoFlow::kFromDrive, kStatuswordObject, "statusword");
  expect(PdoFlow::kFromDrive, kModeDisplayObject, "mode of operation display");
  expect(PdoFlow::kFromDrive, kPositionActualObject, "actual position");
  expect(PdoFlow::kFromDrive, kVelocityActualObject, "actual speed");
  expect(PdoFlow::kFromDrive, kTorqueActualObject, "actual torque");
  if (profile.brake.by == BrakeControl::By::kDigitalOutput) {
    expect(PdoFlow::kToDrive, kDigitalOutputsObject, "digital outputs, for the brake");
  }
  for (const OperationMode mode : profile.modes) {
    switch (mode) {
      case OperationMode::kProfilePosition:
      case OperationMode::kCyclicPosition:
        expect(PdoFlow::kToDrive, kTargetPositionObject, Name(mode));
        break;
      case OperationMode::kProfileVelocity:
      case OperationMode::kCyclicVelocity:
        expect(PdoFlow::kToDrive, kTargetVelocityObject, Name(mode));
        break;
      case OperationMode::kProfileTorque:
      case OperationMode::kCyclicTorque:
        expect(PdoFlow::kToDrive, kTargetTorqueObject, Name(mode));
        break;
      case OperationMode::kHoming:
        break;
      case OperationMode::kNone:
      case OperationMode::kVelocity:
      case OperationMode::kInterpolatedPosition:
        findings.push_back(fmt::format("modes: {} is not a mode of this master", Name(mode)));
        break;
    }
  }
}

}  // namespace

std::vector<std::string> CheckProfile(const DriveProfile& profile) {
  Findings findings;
  CheckNumbers(profile, findings);
  CheckSupervision(profile, findings);
  CheckPdos(profile, findings);
  for (const ProfileObject& object : profile.objects) {
    const std::size_t bytes = BytesOf(object.type);
    if (bytes == 0 || bytes > 4 || object.type == DataType::kReal32) {
      findings.push_back(
          fmt::format("{}: only integers of at most 32 bits can be written", Words(object.address)));
      continue;
    }
    const unsigned bits = 8U * static_cast<unsigned>(bytes);
    const std::int64_t low = IsSignedType(object.type) ? -(std::int64_t{1} << (bits - 1)) : 0;
    const std::int64_t high = (std::int64_t{1} << (IsSignedType(object.type) ? bits - 1 : bits)) - 1;
    if (object.value < low || object.value > high) {
      findings.push_back(
          fmt::format("{}: {} does not fit into {} bits", Words(object.address), object.value, bits));
    }
  }
  return findings;
}

}  // namespace strainwave::protocols::canopen
