// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <numbers>

/// Conversions between SI, used everywhere inside, and the units of the field, used in files and on screens.
namespace strainwave {

inline constexpr double kPi = std::numbers::pi;
inline constexpr double kTwoPi = 2.0 * kPi;
inline constexpr double kArcminPerRad = 10800.0 / kPi;
inline constexpr double kDay_s = 86400.0;

constexpr double RadFromDeg(double angle_deg) { return angle_deg * (kPi / 180.0); }
constexpr double DegFromRad(double angle_rad) { return angle_rad * (180.0 / kPi); }
constexpr double RadFromArcmin(double angle_arcmin) { return angle_arcmin * (kPi / 10800.0); }
constexpr double ArcminFromRad(double angle_rad) { return angle_rad * kArcminPerRad; }
constexpr double RadFromArcsec(double angle_arcsec) { return angle_arcsec * (kPi / 648000.0); }
constexpr double ArcsecFromRad(double angle_rad) { return angle_rad * (648000.0 / kPi); }
constexpr double RadPerSFromRpm(double speed_rpm) { return speed_rpm * (kTwoPi / 60.0); }
constexpr double RpmFromRadPerS(double speed_rad_per_s) { return speed_rad_per_s * (60.0 / kTwoPi); }
constexpr double SecondsFromHours(double time_h) { return time_h * 3600.0; }

}  // namespace strainwave
