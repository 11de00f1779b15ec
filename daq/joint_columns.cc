// SPDX-License-Identifier: Apache-2.0
#include "daq/joint_columns.h"

#include <algorithm>
#include <charconv>

#include <fmt/format.h>

namespace strainwave::daq {
namespace {

// Around the number of the joint.
struct JointColumn {
  JointQuantity quantity;
  std::string_view prefix;
  std::string_view ending;
};
constexpr JointColumn kJointColumns[] = {{JointQuantity::kPosition, "q", "_rad"},
                                         {JointQuantity::kVelocity, "qd", "_rad_per_s"},
                                         {JointQuantity::kAcceleration, "qdd", "_rad_per_s2"},
                                         {JointQuantity::kTorque, "tau", "_Nm"}};

// More than any robot has; a higher number is a mistake in a name.
constexpr std::size_t kMostJoints = 64;

// The number of the joint whose column it is; 0 if it is none.
std::size_t JointOf(std::string_view name) {
  for (const JointColumn& column : kJointColumns) {
    if (!name.starts_with(column.prefix) || !name.ends_with(column.ending) ||
        name.size() <= column.prefix.size() + column.ending.size())
      continue;
    const std::string_view digits =
        name.substr(column.prefix.size(), name.size() - column.prefix.size() - column.ending.size());
    std::size_t joint = 0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), joint);
    if (error == std::errc() && end == digits.data() + digits.size() && digits.front() != '0') return joint;
  }
  return 0;
}

}  // namespace

std::string JointColumnName(JointQuantity quantity, std::size_t joint) {
  const JointColumn& column = *std::ranges::find(kJointColumns, quantity, &JointColumn::quantity);
  return fmt::format("{}{}{}", column.prefix, joint, column.ending);
}

bool IsJointColumn(std::string_view name) { return JointOf(name) != 0; }

std::size_t JointCount(const Record& record) {
  std::size_t joints = 0;
  while (record.FindColumn(JointColumnName(JointQuantity::kPosition, joints + 1)) != nullptr) ++joints;
  return joints;
}

std::vector<JointColumnBreak> CheckJointColumns(const Record& record) {
  std::size_t joints = 0;
  for (const Column& column : record.columns) joints = std::max(joints, JointOf(column.name));
  if (joints > kMostJoints)
    return {{fmt::format("a column has the joint number {}", joints),
             fmt::format("1 to {}, without a gap", kMostJoints)}};
  const bool accelerations = record.FindColumn(JointColumnName(JointQuantity::kAcceleration, 1)) != nullptr;
  std::vector<JointColumnBreak> breaks;
  for (std::size_t joint = 2; joint <= joints; ++joint) {
    for (const JointColumn& column : kJointColumns) {
      const std::string name = JointColumnName(column.quantity, joint);
      const bool optional = column.quantity == JointQuantity::kAcceleration && !accelerations;
      if (optional || record.FindColumn(name) != nullptr) continue;
      breaks.push_back({fmt::format("column '{}' is missing", name),
                        fmt::format("the same columns for each of the joints 1 to {}", joints)});
    }
  }
  return breaks;
}

}  // namespace strainwave::daq
