// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace strainwave::schedules {

/// What a value in a file measures; decides which units it may carry.
enum class Dimension {
  kTime,                   // → s
  kAngle,                  // → rad
  kAngularSpeed,           // → rad/s
  kAngularAcceleration,    // → rad/s²
  kTorque,                 // → N·m
  kTorqueRate,             // → N·m/s
  kFrequency,              // → Hz
  kTemperature,            // → °C
  kTemperatureDifference,  // → K
  kAcceleration,           // → m/s²
  kSensitivity,            // → V/(m/s²)
  kShare,                  // → 1; the only dimension that may go without a unit
};

/// "a time", "a torque", …
std::string DimensionName(Dimension dimension);

/// The accepted units as prose: "us, ms, s, min, h or d". Spellings with the same meaning (°, m/s², N·m) are
/// read but not listed.
std::string AcceptedUnits(Dimension dimension);

/// Reads a number and its unit ("30 min", "2400 rpm", "25.6 kHz") and converts to SI.
///
/// The number is a decimal with a point and an optional exponent; the blank before the unit may be left out.
/// @throws std::invalid_argument saying what was written and which units are accepted, if there is no number,
///   no unit or another dimension's unit, or if the value is not finite or below absolute zero.
double ParseQuantity(std::string_view text, Dimension dimension);

/// Reads a plain decimal number, all of `text`.
/// @throws std::invalid_argument if it is not one or not finite.
double ParseNumber(std::string_view text);

}  // namespace strainwave::schedules
