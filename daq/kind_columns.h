// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <iterator>
#include <span>
#include <string_view>

#include "daq/record_kind.h"

/// The columns that each kind of record gives a meaning (docs/contract.md#record-files), for
/// `record_rules.cc`.
namespace strainwave::daq {

using Names = std::span<const std::string_view>;

inline constexpr std::array<std::string_view, 3> kSweepRequired{"direction", "input_angle_deg",
                                                                "output_angle_deg"};
inline constexpr std::array<std::string_view, 3> kSweepOptional{"time_s", "torque_Nm", "temperature_degC"};
inline constexpr std::array<std::string_view, 3> kLoopRequired{"time_s", "torque_Nm", "output_angle_deg"};
inline constexpr std::array<std::string_view, 1> kLoopOptional{"temperature_degC"};
inline constexpr std::array<std::string_view, 3> kRotaryRequired{"time_s", "position_rad", "torque_Nm"};
inline constexpr std::array<std::string_view, 3> kLinearRequired{"time_s", "position_m", "force_N"};
inline constexpr std::array<std::string_view, 4> kMotionOptional{"velocity_rad_per_s", "velocity_m_per_s",
                                                                 "temperature_degC", "current_A"};
inline constexpr std::array<std::string_view, 5> kVibrationOptional{
    "time_s", "accel_x_m_per_s2", "accel_y_m_per_s2", "accel_z_m_per_s2", "accel_motor_z_m_per_s2"};
inline constexpr std::array<std::string_view, 2> kMotorRequired{"current_A", "velocity_rad_per_s"};
inline constexpr std::array<std::string_view, 2> kMotorOptional{"time_s", "state"};
inline constexpr std::array<std::string_view, 4> kJointsRequired{"time_s", "q1_rad", "qd1_rad_per_s",
                                                                 "tau1_Nm"};
inline constexpr std::array<std::string_view, 1> kHistoryRequired{"time_s"};

struct KindRule {
  RecordKind::Value kind;
  Names required;
  Names required_linear;  // in place of `required`, for a linear axis
  Names optional;
};

inline constexpr KindRule kKindRules[] = {
    {RecordKind::kTransmissionError, kSweepRequired, {}, kSweepOptional},
    {RecordKind::kHysteresis, kLoopRequired, {}, kLoopOptional},
    {RecordKind::kMotion, kRotaryRequired, kLinearRequired, kMotionOptional},
    {RecordKind::kVibration, {}, {}, kVibrationOptional},
    {RecordKind::kMotor, kMotorRequired, {}, kMotorOptional},
    {RecordKind::kJoints, kJointsRequired, {}, {}},
    {RecordKind::kHistory, kHistoryRequired, {}, {}},
};

inline const KindRule* FindRule(const RecordKind& kind) {
  const auto* found = std::find_if(std::begin(kKindRules), std::end(kKindRules),
                                   [&kind](const KindRule& rule) { return kind == rule.kind; });
  return found == std::end(kKindRules) ? nullptr : found;
}

inline bool Contains(Names names, std::string_view name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

}  // namespace strainwave::daq
