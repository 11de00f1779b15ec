// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "daq/record.h"

/// The columns of a record of kind `joints`: of each joint, numbered from 1, its position `q1_rad`, velocity
/// `qd1_rad_per_s` and torque `tau1_Nm`, and where measured its acceleration `qdd1_rad_per_s2`.
namespace strainwave::daq {

enum class JointQuantity { kPosition, kVelocity, kAcceleration, kTorque };

/// @param joint  from 1
std::string JointColumnName(JointQuantity quantity, std::size_t joint);

bool IsJointColumn(std::string_view name);

/// How many joints there are without a gap.
std::size_t JointCount(const Record& record);

struct JointColumnBreak {
  std::string what;
  std::string expected;
};
/// What the joints behind the first lack: each has the same columns as it, without a gap in the numbers.
std::vector<JointColumnBreak> CheckJointColumns(const Record& record);

}  // namespace strainwave::daq
