// SPDX-License-Identifier: Apache-2.0
#include "bench/configuration/read_register_map.h"

#include <limits>
#include <stdexcept>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "bench/configuration/bench_bounds.h"
#include "bench/configuration/device_file.h"
#include "bench/seconds.h"
#include "schedules/reader/quantity.h"
#include "schedules/reader/yaml_map.h"

namespace strainwave::bench {
namespace {

using namespace protocols::modbus;
using protocols::PowerState;
using schedules::Bound;
using schedules::Dimension;
using schedules::FindingList;
using schedules::Presence;
using schedules::ReadContext;
using schedules::YamlMap;
using schedules::YamlNode;

constexpr schedules::FileKind kRegisterFile{"Modbus device", "modbus_device: 1"};

// What a unit of the field is in SI; a unit that is none of ours is left as it is.
std::pair<double, std::string> InSi(const std::string& unit) {
  constexpr std::pair<Dimension, const char*> kDimensions[] = {
      {Dimension::kTime, "s"},
      {Dimension::kAngle, "rad"},
      {Dimension::kAngularSpeed, "rad/s"},
      {Dimension::kAngularAcceleration, "rad/s2"},
      {Dimension::kTorque, "Nm"},
      {Dimension::kTorqueRate, "Nm/s"},
      {Dimension::kFrequency, "Hz"},
      {Dimension::kTemperature, "degC"},
      {Dimension::kTemperatureDifference, "K"},
      {Dimension::kAcceleration, "m/s2"},
  };
  for (const auto& [dimension, si] : kDimensions) {
    try {
      return {schedules::ParseQuantity("1 " + unit, dimension), si};
    } catch (const std::invalid_argument&) {
      continue;
    }
  }
  return {1.0, unit};
}

std::optional<double> OptionalNumber(YamlMap& map, std::string_view key, double factor) {
  const double number = map.has(key) ? map.Number(key, Bound::kAny) : map.Number(key, Bound::kAny, "0");
  return map.has(key) ? std::optional(number * factor) : std::nullopt;
}

Register ReadRegister(YamlMap& map) {
  Register value;
  value.name = map.Identifier("name");
  value.address = static_cast<std::uint16_t>(map.Count("address", 0, 65535));
  value.table = map.Choice<Table>("table",
                                  {{"holding", Table::kHolding},
                                   {"input", Table::kInput},
                                   {"coil", Table::kCoil},
                                   {"discrete", Table::kDiscrete}},
                                  "holding");
  value.type = map.Choice<ValueType>("type",
                                     {{"int16", ValueType::kInt16},
                                      {"uint16", ValueType::kUint16},
                                      {"int32", ValueType::kInt32},
                                      {"uint32", ValueType::kUint32},
                                      {"float32", ValueType::kFloat32},
                                      {"bit", ValueType::kBit}},
                                     IsBits(value.table) ? "bit" : "uint16");
  value.word_order = map.Choice<WordOrder>(
      "word_order", {{"high_first", WordOrder::kHighFirst}, {"low_first", WordOrder::kLowFirst}},
      "high_first");
  value.byte_order = map.Choice<ByteOrder>(
      "byte_order", {{"high_first", ByteOrder::kHighFirst}, {"low_first", ByteOrder::kLowFirst}},
      "high_first");
  const auto [factor, unit] = InSi(map.Text("unit", ""));
  value.unit = unit;
  value.scale = factor * map.Number("scale", Bound::kNotZero, "1");
  value.offset = factor * map.Number("offset", Bound::kAny, "0");
  value.least = OptionalNumber(map, "least", factor);
  value.most = OptionalNumber(map, "most", factor);
  value.access = map.Choice<Access>(
      "access", {{"read", Access::kRead}, {"write", Access::kWrite}, {"read_write", Access::kReadWrite}},
      "read");
  value.poll_period =
      Nanoseconds(map.OptionalQuantity("poll", Dimension::kTime, Bound::kPositive).value_or(0));
  value.good_for =
      Nanoseconds(map.OptionalQuantity("good_for", Dimension::kTime, Bound::kPositive).value_or(0));
  map.Finish();
  return value;
}

ModbusServoProfile::Status ReadStatus(YamlMap& map) {
  ModbusServoProfile::Status row;
  constexpr int kMost = std::numeric_limits<int>::max();
  row.mask = static_cast<std::uint32_t>(map.Count("mask", 0, kMost));
  row.value = static_cast<std::uint32_t>(map.Count("value", 0, kMost));
  row.state = map.Choice<PowerState>("state", {{"off", PowerState::kSwitchOnDisabled},
                                               {"ready", PowerState::kSwitchedOn},
                                               {"enabled", PowerState::kOperationEnabled},
                                               {"stopping", PowerState::kQuickStopActive},
                                               {"fault", PowerState::kFault}});
  if ((row.value & ~row.mask) != 0) {
    map.AddError("value",
                 fmt::format("value = {} has bits outside of mask = {}, so that it never fits (expected "
                             "bits of the mask)",
                             row.value, row.mask));
  }
  map.Finish();
  return row;
}

ModbusServoProfile ReadServo(YamlMap& map) {
  ModbusServoProfile servo;
  servo.period = Nanoseconds(map.Quantity("write_period", Dimension::kTime, Bound::kPositive));
  servo.watchdog_time = Nanoseconds(map.Quantity("watchdog_time", Dimension::kTime, Bound::kPositive));
  servo.shaft = map.Choice<ModbusServoProfile::Shaft>(
      "shaft",
      {{"motor", ModbusServoProfile::Shaft::kMotor}, {"output", ModbusServoProfile::Shaft::kOutput}});
  YamlMap control = map.Map("control", Presence::kRequired);
  servo.control.off = control.Number("off", Bound::kAny);
  servo.control.enable = control.Number("enable", Bound::kAny);
  servo.control.quick_stop = control.Number("quick_stop", Bound::kAny);
  servo.control.reset_fault = control.Number("reset_fault", Bound::kAny);
  control.Finish();
  YamlMap mode = map.Map("mode", Presence::kRequired);
  servo.speed_mode = mode.Number("speed", Bound::kAny);
  servo.torque_mode = mode.Number("torque", Bound::kAny);
  mode.Finish();
  YamlMap brake = map.Map("brake", Presence::kRequired);
  servo.brake_engaged = brake.Number("engaged", Bound::kAny);
  servo.brake_released = brake.Number("released", Bound::kAny);
  brake.Finish();
  for (YamlMap& row : map.MapList("status", Presence::kRequired)) servo.status.push_back(ReadStatus(row));
  map.Finish();
  return servo;
}

ModbusProfile ReadModbusDevice(const YamlNode& root, ReadContext& context) {
  context.bounds = DeviceBounds();
  YamlMap map(root, context);
  map.Version("modbus_device");
  ModbusProfile profile;
  profile.map.device = map.Text("device");
  profile.map.most_registers = map.Count("most_registers", 2, 125, "125");
  profile.map.read_gap = map.Count("read_gap", 0, 125, "0");
  std::vector<YamlMap> registers = map.MapList("registers", Presence::kRequired);
  for (YamlMap& one : registers) profile.map.registers.push_back(ReadRegister(one));
  if (!context.findings.has_errors()) {
    for (const MapProblem& problem : CheckMap(profile.map)) {
      registers[problem.index].AddError("name", problem.what);
    }
  }
  YamlMap servo = map.Map("servo", Presence::kOptional);
  if (map.has("servo")) profile.servo = ReadServo(servo);
  map.Finish();
  // What a wrong line stands for is not known, so nothing is said of how the lines fit together.
  if (profile.servo && !context.findings.has_errors()) {
    for (const std::string& problem : CheckServoProfile(profile.map, *profile.servo)) {
      map.AddError("servo", problem);
    }
  }
  return profile;
}

}  // namespace

ModbusProfile ReadModbusProfile(const std::filesystem::path& path) {
  return ParseModbusProfile(TextOfFile<ModbusProfileError>(path, kRegisterFile), path.string());
}

ModbusProfile ParseModbusProfile(const std::string& text, std::string_view file_name) {
  return ParseFile<ModbusProfileError>(text, file_name, kRegisterFile, ReadModbusDevice);
}

}  // namespace strainwave::bench
