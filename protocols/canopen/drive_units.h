// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

namespace strainwave::protocols::canopen {

/// How a drive counts, against rad, rad/s and N·m at the axis that the bench speaks of. The one place where
/// units of the wire meet SI.
struct DriveUnits {
  double position_counts_per_rev{};              // of the motor shaft, in units of 6064h
  double velocity_units_per_rpm{1.0};            // of the motor shaft, in units of 606Ch
  double acceleration_units_per_rpm_per_s{1.0};  // of 6083h, 6085h
  double rated_torque_Nm{};                      // of the motor; torque objects are in per mille of it
  double rated_torque_units_per_Nm{1000.0};      // of 6076h, which says the same: mN·m by the standard
  double gear_ratio{1.0};                        // turns of the motor for one of the axis, > 0
  int sign{1};                                   // -1 where the motor's positive is the axis's negative

  bool operator==(const DriveUnits&) const = default;
};

/// The nearest number of the drive; nothing where the value is not finite or the number above 32 bits
/// (torque: 16 bits; position, which is counted on where 32 bits go over: 53 bits).
std::optional<std::int64_t> PositionCounts(const DriveUnits& units, double position_rad) noexcept;
std::optional<std::int32_t> VelocityUnits(const DriveUnits& units, double speed_rad_per_s) noexcept;
std::optional<std::int16_t> TorquePerMille(const DriveUnits& units, double torque_Nm) noexcept;

double PositionRad(const DriveUnits& units, std::int64_t counts) noexcept;
double SpeedRadPerS(const DriveUnits& units, std::int32_t velocity_units) noexcept;
double TorqueNm(const DriveUnits& units, std::int16_t per_mille) noexcept;

/// For limits, which have no sign: the nearest number of the drive, cut to the object's largest. The window
/// stays one below it, as FFFFFFFFh switches following error control off (6065h).
std::uint32_t PositionWindowCounts(const DriveUnits& units, double window_rad) noexcept;
std::uint32_t VelocityLimitUnits(const DriveUnits& units, double speed_rad_per_s) noexcept;
std::uint32_t AccelerationUnits(const DriveUnits& units, double acceleration_rad_per_s2) noexcept;
std::uint16_t TorqueLimitPerMille(const DriveUnits& units, double torque_Nm) noexcept;

}  // namespace strainwave::protocols::canopen
