// SPDX-License-Identifier: Apache-2.0
#include "bench/configuration/read_register_map.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <numbers>

#include "protocols/modbus/read_plan.h"
#include "tests/checkout.h"

namespace strainwave::bench::modbus_profile_test {
namespace {

using namespace std::chrono_literals;
using namespace protocols::modbus;

const std::filesystem::path kProfiles = std::filesystem::path(SourceFolder()) / "bench/devices/profiles";

std::string ErrorsOf(const std::string& text) {
  try {
    ParseModbusProfile(text, "d.yaml");
  } catch (const ModbusProfileError& error) {
    return error.what();
  }
  return "none";
}

const std::string kHead = "modbus_device: 1\ndevice: amplifier\nregisters:\n";

TEST(ModbusProfile, EveryShippedFileIsSound) {
  int files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(kProfiles)) {
    const std::string name = entry.path().filename().string();
    if (!name.starts_with("modbus_")) continue;
    ++files;
    EXPECT_NO_THROW(ReadModbusProfile(entry.path())) << name;
  }
  EXPECT_GE(files, 3);
}

TEST(ModbusProfile, OfTheServoDriveIsInSiAndReadInTwoRequests) {
  const ModbusProfile profile = ReadModbusProfile(kProfiles / "modbus_servo_drive.yaml");
  const Register& speed = profile.map.registers[*Find(profile.map, "speed_set_point")];
  EXPECT_EQ(speed.unit, "rad/s");
  EXPECT_DOUBLE_EQ(speed.scale, 0.01 * 2 * std::numbers::pi / 60);
  EXPECT_EQ(profile.map.registers[*Find(profile.map, "watchdog_time")].unit, "s");
  EXPECT_DOUBLE_EQ(profile.map.registers[*Find(profile.map, "watchdog_time")].scale, 1e-3);
  EXPECT_EQ(profile.servo->watchdog_time, 200ms);
  EXPECT_EQ(profile.servo->status.size(), 5U);
  std::vector<std::size_t> polled;
  for (std::size_t i = 0; i < profile.map.registers.size(); ++i) {
    if (profile.map.registers[i].poll_period.count() > 0) polled.push_back(i);
  }
  EXPECT_EQ(PlanReads(profile.map, polled).size(), 2U);
}

TEST(ModbusProfile, ReadsEveryKeyOfARegister) {
  const ModbusProfile profile =
      ParseModbusProfile(kHead +
                             "  - {name: t, address: 7, table: input, type: int32, word_order: low_first, "
                             "byte_order: low_first, unit: Ncm, "
                             "scale: 2, offset: 50, least: -100, most: 300, poll: 20 ms, good_for: 1 s}\n",
                         "d.yaml");
  const Register& value = profile.map.registers.at(0);
  EXPECT_EQ(value.address, 7);
  EXPECT_EQ(value.table, Table::kInput);
  EXPECT_EQ(value.type, ValueType::kInt32);
  EXPECT_EQ(value.word_order, WordOrder::kLowFirst);
  EXPECT_EQ(value.byte_order, ByteOrder::kLowFirst);
  EXPECT_EQ(value.unit, "Nm");
  EXPECT_DOUBLE_EQ(value.scale, 0.02);
  EXPECT_DOUBLE_EQ(value.offset, 0.5);
  EXPECT_DOUBLE_EQ(*value.least, -1.0);
  EXPECT_DOUBLE_EQ(*value.most, 3.0);
  EXPECT_EQ(value.poll_period, 20ms);
  EXPECT_EQ(value.good_for, 1s);
}

TEST(ModbusProfile, LeavesAUnitThatIsNoneOfOursAlone) {
  const ModbusProfile profile =
      ParseModbusProfile(kHead + "  - {name: u, address: 0, unit: mV/V, scale: 0.5}\n", "d");
  EXPECT_EQ(profile.map.registers.at(0).unit, "mV/V");
  EXPECT_EQ(profile.map.registers.at(0).scale, 0.5);
}

TEST(ModbusProfile, TellsAllMistakesWithTheirPlace) {
  EXPECT_EQ(
      ErrorsOf("modbus_device: 1\n"
               "registers:\n"
               "  - {name: a, address: 70000}\n"
               "  - {name: b, address: 1, type: int64}\n"
               "  - {name: c, address: 2, pol: 1 s}\n"
               "  - {name: d, address: 3, poll: 5}\n"),
      "d.yaml:1:1: error: missing key 'device' (expected one line of 1 to 200 characters)\n"
      "d.yaml:3:24: error: address = 70000: out of range (expected a whole number from 0 to 65535)\n"
      "d.yaml:4:33: error: type = int64: not known (expected int16, uint16, int32, "
      "uint32, float32 or bit)\n"
      "d.yaml:5:27: error: unknown key 'pol', did you mean 'poll'? (expected name, address, table, type, "
      "word_order, byte_order, unit, scale, offset, least, most, access, poll, good_for)\n"
      "d.yaml:6:33: error: poll = 5: no unit (expected us, ms, s, min, h or d)");
}

TEST(ModbusProfile, TellsWhereAMapContradictsItself) {
  EXPECT_EQ(
      ErrorsOf(kHead + "  - {name: a, address: 0, type: float32}\n"
                       "  - {name: b, address: 1}\n"
                       "  - {name: c, address: 0, table: input, access: write}\n"),
      "d.yaml:5:12: error: 'b' at 1 lies over 'a' at 0 of the holding table (expected each address once)\n"
      "d.yaml:6:12: error: 'c' is to be written in the input table, which is read-only (expected access "
      "read)");
}

TEST(ModbusProfile, RefusesAWatchdogThatBitesTooLate) {
  const std::string errors = ErrorsOf(kHead +
                                      "  - {name: a, address: 0, poll: 1 h}\nservo:\n  write_period: 1 s\n"
                                      "  watchdog_time: 10 s\n");
  for (const char* line : {"d.yaml:4:33: error: poll = 1 h is above 1 min (expected no more, since a value "
                           "that is read so seldom watches "
                           "nothing)",
                           "d.yaml:6:17: error: write_period = 1 s is above 500 ms (expected no more, since "
                           "set points and stops wait for "
                           "it)",
                           "d.yaml:7:18: error: watchdog_time = 10 s is above 2 s (expected no more, since "
                           "the shafts turn unwatched "
                           "meanwhile)"}) {
    EXPECT_NE(errors.find(line), std::string::npos) << line << "\n" << errors;
  }
}

TEST(ModbusProfile, TellsWhatAServoDriveLacks) {
  const std::string servo =
      "servo:\n  shaft: motor\n  write_period: 20 ms\n  watchdog_time: 30 ms\n  control: {off: 0, enable: 0, "
      "quick_stop: 2, "
      "reset_fault: 4}\n  mode: {speed: 1, torque: 2}\n  brake: {engaged: 1, released: 1}\n  status:\n"
      "    - {mask: 1, value: 1, state: ready}\n";
  std::string registers;
  int address = 0;
  for (const char* name :
       {"control", "mode", "torque_set_point", "brake", "watchdog_time", "status", "actual_speed"}) {
    registers += "  - {name: " + std::string(name) + ", address: " + std::to_string(address++) +
                 ", access: read_write, unit: " + (name == std::string("torque_set_point") ? "Ncm" : "rpm") +
                 "}\n";
  }
  const std::string errors = ErrorsOf(kHead + registers + servo);
  for (const char* part :
       {"d.yaml:11:1: error: a servo drive needs a register 'speed_set_point'\n",
        "d.yaml:11:1: error: a servo drive needs a register 'actual_torque'\n",
        "'control' is in 'rad/s' (expected a unit of '')", "'status' must be polled",
        "'actual_speed' must be polled", "the control word 'enable' is also one that stops",
        "the brake is released by the word that engages it", "no row of the status says 'operation enabled'",
        "the watchdog time is shorter than two periods of writing"}) {
    EXPECT_NE(errors.find(part), std::string::npos) << part << "\n" << errors;
  }
  EXPECT_EQ(errors.find("'torque_set_point' is in"), std::string::npos);
  EXPECT_NE(
      ErrorsOf(kHead + registers + "servo:\n  status:\n    - {mask: 1, value: 2, state: enabled}\n")
          .find("value = 2 has bits outside of mask = 1, so that it never fits (expected bits of the mask)"),
      std::string::npos);
}

}  // namespace
}  // namespace strainwave::bench::modbus_profile_test
