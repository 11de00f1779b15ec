// SPDX-License-Identifier: Apache-2.0
#include "protocols/canopen/drive_units.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "analysis/units.h"

namespace strainwave::protocols::canopen {
namespace {

template <typename Integer>
std::optional<Integer> Nearest(double value, Integer least = std::numeric_limits<Integer>::min(),
                               Integer most = std::numeric_limits<Integer>::max()) {
  const double rounded = std::round(value);
  // Written so that NaN falls through; limits of up to 53 bits are exact as doubles.
  if (rounded >= static_cast<double>(least) && rounded <= static_cast<double>(most)) {
    return static_cast<Integer>(rounded);
  }
  return std::nullopt;
}

constexpr std::int64_t kMostCounts = std::int64_t{1} << 53;

// A limit that does not fit is no limit to the drive: the largest number says the same.
std::uint32_t Limit(double value, std::uint32_t most) {
  if (!(value > 0.0)) return 0;
  return static_cast<std::uint32_t>(std::min(std::round(value), static_cast<double>(most)));
}

constexpr auto kMost32 = std::numeric_limits<std::uint32_t>::max();

double CountsPerRad(const DriveUnits& units) {
  return units.position_counts_per_rev * units.gear_ratio / kTwoPi;
}

double VelocityUnitsPerRadPerS(const DriveUnits& units) {
  return units.velocity_units_per_rpm * units.gear_ratio * RpmFromRadPerS(1.0);
}

double PerMillePerNm(const DriveUnits& units) { return 1000.0 / (units.rated_torque_Nm * units.gear_ratio); }

}  // namespace

std::optional<std::int64_t> PositionCounts(const DriveUnits& units, double position_rad) noexcept {
  return Nearest(units.sign * position_rad * CountsPerRad(units), -kMostCounts, kMostCounts);
}

std::optional<std::int32_t> VelocityUnits(const DriveUnits& units, double speed_rad_per_s) noexcept {
  return Nearest<std::int32_t>(units.sign * speed_rad_per_s * VelocityUnitsPerRadPerS(units));
}

std::optional<std::int16_t> TorquePerMille(const DriveUnits& units, double torque_Nm) noexcept {
  return Nearest<std::int16_t>(units.sign * torque_Nm * PerMillePerNm(units));
}

double PositionRad(const DriveUnits& units, std::int64_t counts) noexcept {
  return units.sign * static_cast<double>(counts) / CountsPerRad(units);
}

double SpeedRadPerS(const DriveUnits& units, std::int32_t velocity_units) noexcept {
  return units.sign * static_cast<double>(velocity_units) / VelocityUnitsPerRadPerS(units);
}

double TorqueNm(const DriveUnits& units, std::int16_t per_mille) noexcept {
  return units.sign * per_mille / PerMillePerNm(units);
}

std::uint32_t PositionWindowCounts(const DriveUnits& units, double window_rad) noexcept {
  return Limit(window_rad * CountsPerRad(units), kMost32 - 1);
}

std::uint32_t VelocityLimitUnits(const DriveUnits& units, double speed_rad_per_s) noexcept {
  return Limit(speed_rad_per_s * VelocityUnitsPerRadPerS(units), kMost32);
}

std::uint32_t AccelerationUnits(const DriveUnits& units, double acceleration_rad_per_s2) noexcept {
  return Limit(acceleration_rad_per_s2 * units.acceleration_units_per_rpm_per_s * units.gear_ratio *
                   RpmFromRadPerS(1.0),
               kMost32);
}

std::uint16_t TorqueLimitPerMille(const DriveUnits& units, double torque_Nm) noexcept {
  return static_cast<std::uint16_t>(Limit(torque_Nm * PerMillePerNm(units), 0xFFFF));
}

}  // namespace strainwave::protocols::canopen
