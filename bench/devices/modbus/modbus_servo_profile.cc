// SPDX-License-Identifier: Apache-2.0
#include "bench/devices/modbus/modbus_servo_profile.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <stdexcept>

#include "protocols/modbus/register_codec.h"

namespace strainwave::bench {
namespace {

namespace mb = protocols::modbus;

struct Need {
  const char* name;
  const char* unit;
  bool read, polled, write, optional;
};
constexpr Need kNeeds[] = {
    {"control", "", false, false, true, false},
    {"status", "", true, true, false, false},
    {"mode", "", false, false, true, false},
    {"speed_set_point", "rad/s", false, false, true, false},
    {"torque_set_point", "Nm", false, false, true, false},
    {"actual_speed", "rad/s", true, true, false, false},
    {"actual_torque", "Nm", true, true, false, false},
    {"actual_position", "rad", true, true, false, true},
    {"brake", "", true, true, true, false},
    {"watchdog_time", "s", true, false, true, false},
    {"watchdog", "", false, false, true, true},
    {"product_code", "", true, false, false, true},
    {"serial_number", "", true, false, false, true},
    {"fault_code", "", true, false, false, true},
};

void CheckNeed(const mb::RegisterMap& map, const Need& need, std::vector<std::string>& problems) {
  const auto found = Find(map, need.name);
  if (!found) {
    if (!need.optional) problems.push_back(fmt::format("a servo drive needs a register '{}'", need.name));
    return;
  }
  const mb::Register& value = map.registers[*found];
  if (value.unit != need.unit) {
    problems.push_back(
        fmt::format("'{}' is in '{}' (expected a unit of '{}')", need.name, value.unit, need.unit));
  }
  if (need.read && !CanRead(value)) problems.push_back(fmt::format("'{}' must be readable", need.name));
  if (need.write && !CanWrite(value)) problems.push_back(fmt::format("'{}' must be writable", need.name));
  if (need.polled && value.poll_period.count() == 0) {
    problems.push_back(fmt::format("'{}' must be polled", need.name));
  }
}

}  // namespace

mb::RegisterMap AtAxis(mb::RegisterMap map, const ModbusServoProfile& profile, double reducer_ratio) {
  if (profile.shaft == ModbusServoProfile::Shaft::kOutput) return map;
  const auto multiply = [&map](const char* name, double factor) {
    const auto found = Find(map, name);
    if (!found) return;
    mb::Register& value = map.registers[*found];
    value.scale *= factor;
    value.offset *= factor;
    if (value.least) *value.least *= factor;
    if (value.most) *value.most *= factor;
  };
  for (const char* name : {"torque_set_point", "actual_torque"}) multiply(name, reducer_ratio);
  for (const char* name : {"speed_set_point", "actual_speed", "actual_position"})
    multiply(name, 1.0 / reducer_ratio);
  return map;
}

double LargestSetPoint(const mb::Register& value) {
  using Limits16 = std::numeric_limits<std::int16_t>;
  using Limits32 = std::numeric_limits<std::int32_t>;
  constexpr double kAny = std::numeric_limits<double>::infinity();
  double lowest = -kAny;
  double highest = kAny;
  switch (value.type) {
    case mb::ValueType::kInt16:
      lowest = Limits16::min();
      highest = Limits16::max();
      break;
    case mb::ValueType::kUint16:
      lowest = 0.0;
      highest = std::numeric_limits<std::uint16_t>::max();
      break;
    case mb::ValueType::kInt32:
      lowest = Limits32::min();
      highest = Limits32::max();
      break;
    case mb::ValueType::kUint32:
      lowest = 0.0;
      highest = std::numeric_limits<std::uint32_t>::max();
      break;
    case mb::ValueType::kBit:
      return 0.0;
    case mb::ValueType::kFloat32:
      break;
  }
  const double one = lowest * value.scale + value.offset;
  const double other = highest * value.scale + value.offset;
  const double least = std::max(std::min(one, other), value.least.value_or(-kAny));
  const double most = std::min(std::max(one, other), value.most.value_or(kAny));
  return std::max(0.0, std::min(-least, most));
}

std::vector<std::string> CheckServoProfile(const mb::RegisterMap& map, const ModbusServoProfile& profile) {
  std::vector<std::string> problems;
  for (const Need& need : kNeeds) CheckNeed(map, need, problems);
  const auto fits = [&](const char* name, double number) {
    const auto found = Find(map, name);
    if (found && Encode(map.registers[*found], number).problem != mb::CodecProblem::kNone) {
      problems.push_back(fmt::format("'{}' cannot hold {}", name, number));
    }
  };
  for (const double word : {profile.control.off, profile.control.enable, profile.control.quick_stop,
                            profile.control.reset_fault}) {
    fits("control", word);
  }
  for (const char* name : {"speed_set_point", "torque_set_point"}) fits(name, 0.0);
  for (const double count : {0.0, 32767.0}) fits("watchdog", count);
  for (const double mode : {profile.speed_mode, profile.torque_mode}) fits("mode", mode);
  for (const double brake : {profile.brake_engaged, profile.brake_released}) fits("brake", brake);
  fits("watchdog_time", std::chrono::duration<double>(profile.watchdog_time).count());
  if (profile.control.enable == profile.control.off || profile.control.enable == profile.control.quick_stop) {
    problems.emplace_back("the control word 'enable' is also one that stops");
  }
  if (profile.brake_engaged == profile.brake_released) {
    problems.emplace_back("the brake is released by the word that engages it");
  }
  const bool can_enable = std::ranges::any_of(profile.status, [](const ModbusServoProfile::Status& row) {
    return row.state == protocols::PowerState::kOperationEnabled && (row.value & ~row.mask) == 0;
  });
  if (!can_enable) problems.emplace_back("no row of the status says 'operation enabled'");
  if (profile.period.count() <= 0) problems.emplace_back("the period of writing is not above zero");
  if (profile.watchdog_time < 2 * profile.period) {
    problems.emplace_back("the watchdog time is shorter than two periods of writing");
  }
  return problems;
}

ModbusServoRegisters FindServoRegisters(const mb::RegisterMap& map, const ModbusServoProfile& profile) {
  const std::vector<std::string> problems = CheckServoProfile(map, profile);
  if (!problems.empty()) {
    throw std::invalid_argument(fmt::format("servo drive {}: {}", map.device, fmt::join(problems, "; ")));
  }
  ModbusServoRegisters at;
  at.control = *Find(map, "control");
  at.status = *Find(map, "status");
  at.mode = *Find(map, "mode");
  at.speed_set_point = *Find(map, "speed_set_point");
  at.torque_set_point = *Find(map, "torque_set_point");
  at.actual_speed = *Find(map, "actual_speed");
  at.actual_torque = *Find(map, "actual_torque");
  at.brake = *Find(map, "brake");
  at.watchdog_time = *Find(map, "watchdog_time");
  at.actual_position = Find(map, "actual_position");
  at.watchdog = Find(map, "watchdog");
  at.product_code = Find(map, "product_code");
  at.serial_number = Find(map, "serial_number");
  at.fault_code = Find(map, "fault_code");
  return at;
}

std::string FaultWords(double code) {
  if (!std::isfinite(code)) return "in fault";
  const bool is_number = code >= 0.0 && code <= std::numeric_limits<std::uint32_t>::max();
  return is_number ? fmt::format("in fault, code {0} ({0:X}h)", static_cast<std::uint32_t>(code))
                   : fmt::format("in fault, code {:g}", code);
}

}  // namespace strainwave::bench
