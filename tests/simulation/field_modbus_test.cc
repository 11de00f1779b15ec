// SPDX-License-Identifier: Apache-2.0
// A bench of metal whose drives, torque amplifier or chamber are on Modbus, and one with a sensor's data
// sheet.
#include <algorithm>
#include <cmath>
#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "bench/configuration/read_bench_file.h"
#include "bench/configuration/read_register_map.h"
#include "bench/errors/bench_error.h"
#include "bench/machines/device_side/modbus_device.h"
#include "bench/machines/device_side/modbus_servo_model.h"
#include "bench/machines/field/field_machine.h"
#include "tests/checkout.h"
#include "tests/schedules/schedule_text.h"
#include "tests/simulation/field_bench.h"
#include "tests/simulation/until.h"

namespace strainwave::bench::field_modbus_test {
namespace {

std::string WithAmplifierAndChamber() {
  const std::string profiles = "../../../bench/devices/profiles/";
  std::string text = BenchText();
  text = schedules::With(
      text, "devices:\n",
      "devices:\n"
      "  - {name: amplifier, kind: torque_amplifier, address: \"tcp:127.0.0.1:0\", registers: " +
          profiles +
          "modbus_torque_amplifier.yaml}\n"
          "  - {name: chamber, kind: temperature_controller, address: \"tcp:127.0.0.1:0\", "
          "registers: " +
          profiles + "modbus_temperature_controller.yaml, set_point: 40 degC}\n");
  text = schedules::With(text, "device: encoders, source: torque_Nm", "device: amplifier, source: torque_Nm");
  return schedules::With(text, "device: thermometers, source: ambient_temperature_degC",
                         "device: chamber, source: temperature_degC");
}

FieldMachine::DeviceState StateOf(const FieldMachine& machine, const std::string& device) {
  for (const FieldMachine::DeviceState& state : machine.States()) {
    if (state.device == device) return state;
  }
  return {};
}

TEST(ModbusChannels, TakesTheTorqueOfAnAmplifierOnlyBesideAGoodStatus) {
  FieldMachine machine(ParseBenchFile(WithAmplifierAndChamber(), "real.yaml", Folder()), 80.0, {});
  Sampler& sampler = machine.Devices().sampler;
  DeviceSide& devices = *machine.device_side();
  Until([&] { return sampler.Read().bad_channels == 0; });
  EXPECT_NEAR(sampler.Read().output_torque_Nm, 0.0, 1.0);
  EXPECT_TRUE(StateOf(machine, "amplifier").good);
  // What the register says is what comes.
  devices.Do("modbus amplifier drift 0 100");
  Until([&] { return sampler.Read().output_torque_Nm > 20.0; });
  devices.Do("modbus amplifier drift 0 0");
  Until([&] { return std::abs(sampler.Read().output_torque_Nm) < 1.0; });
  devices.Do("modbus amplifier drift 1 100");
  constexpr unsigned kTorque = 1U << static_cast<unsigned>(Channel::kOutputTorque);
  Until([&] { return sampler.Read().bad_channels == kTorque; });
  Until([&] { return !StateOf(machine, "amplifier").good; });
  const auto bad = machine.BadChannels();
  ASSERT_EQ(bad.size(), 1U);
  EXPECT_EQ(bad[0].channel, "output_torque");
  EXPECT_TRUE(bad[0].reason.starts_with("amplifier: its status is ")) << bad[0].reason;
  EXPECT_TRUE(bad[0].reason.ends_with(" (expected 0 to 0): the torque is not believed")) << bad[0].reason;
  devices.Do("modbus amplifier drift 1 0");
  Until([&] { return sampler.Read().bad_channels == 0; });
  EXPECT_TRUE(machine.BadChannels().empty());
}

TEST(ModbusChannels, HeatsAChamberToTheSetPointOfTheBenchFile) {
  const BenchDescription bench = ParseBenchFile(WithAmplifierAndChamber(), "real.yaml", Folder());
  {
    FieldMachine machine(bench, 80.0, {});
    Sampler& sampler = machine.Devices().sampler;
    Until([&] { return sampler.Read().bad_channels == 0; });
    EXPECT_NEAR(sampler.Read().ambient_temperature_degC, 21.0, 3.0);
    // As the controller says it, after it was written.
    Until([&] { return StateOf(machine, "chamber").state == "connected, set point 40.0 degC"; });
    EXPECT_TRUE(StateOf(machine, "chamber").good);
  }
  // Who only looks changes no set point.
  const FieldMachine looking(bench, 80.0, {}, FieldMachine::Use::kLook);
  Until([&] { return StateOf(looking, "chamber").state == "connected, set point 0.0 degC"; });
}

TEST(ModbusChannels, RefusesAChannelThatADeviceOfOneRoleHasNot) {
  const BenchDescription bench =
      ParseBenchFile(schedules::With(WithAmplifierAndChamber(), "device: amplifier, source: torque_Nm",
                                     "device: amplifier, source: force_Nm"),
                     "real.yaml", Folder());
  try {
    const FieldMachine machine(bench, 80.0, {});
    FAIL();
  } catch (const BenchError& error) {
    EXPECT_STREQ(error.what(),
                 "real.yaml: error: line 52: device amplifier has no channel force_Nm (must be torque_Nm)");
  }
}

// The device says 8388607 counts for 125 Nm; by the data sheet the same counts are half of what it says.
TEST(ModbusChannels, ScalesASensorByTheDataSheetOfTheBenchFile) {
  const std::string text = schedules::With(
      schedules::With(BenchText(), "  serial: DEV-TORQUE\n", ""), "  calibration: DEV-CAL-TORQUE\n",
      "  teds:\n"
      "    basic: 2B C0 F2 66 30 87 D6 12\n"
      "    counts_per_volt: 6710885600\n"  // counts per V/V
      "    fields: {\"%MinPhysVal\": -100, \"%MaxPhysVal\": 100, \"%MinElecVal\": -0.002, "
      "\"%MaxElecVal\": 0.002}\n");
  FieldMachine machine(ParseBenchFile(text, "real.yaml", Folder()), 80.0, {});
  const auto calibrations = machine.Calibrations();
  const auto torque = std::ranges::find(calibrations, "output_torque", &ChannelCalibration::channel);
  ASSERT_NE(torque, calibrations.end());
  EXPECT_EQ(torque->calibration.id, "TEDS 1234567 C12 without date");
  EXPECT_EQ(torque->sensor_serial, "1234567");
  Sampler& sampler = machine.Devices().sampler;
  Until([&] { return sampler.Read().bad_channels == 0; });
  sampler.ConnectShunt(true);
  Until([&] { return sampler.Read().output_torque_Nm > 24.0; });
  EXPECT_NEAR(sampler.Read().output_torque_Nm, 25.0, 0.5);
  sampler.ConnectShunt(false);
}

// A servo drive on Modbus TCP.
struct ServoOnTcp {
  MonotonicClock clock;
  ModbusProfile profile =
      ReadModbusProfile(SourceFolder() + "/bench/devices/profiles/modbus_servo_drive.yaml");
  ModbusServoModel model{profile.map, *profile.servo};
  ModbusDevice device{
      profile.map,
      1,
      {[this](std::size_t index) { return model.Read(index, clock.Now()); },
       [this](std::size_t index, double value) { return model.Write(index, value, clock.Now()); },
       [this] { model.Hear(clock.Now()); }},
      ModbusDevice::Tcp{}};
};

// A bench whose drives are on Modbus, and whose streams cannot be reached: the drives come first.
class ModbusDrives : public testing::Test {
 protected:
  std::string MessageOf(FieldMachine::Use use) {
    std::string text =
        schedules::With(BenchText(), "{device: can, node: 1, profile: drive.yaml}", "{device: driving}");
    text = schedules::With(text, "{device: can, node: 2, profile: drive.yaml}", "{device: load}");
    const auto device = [](const char* name, const ServoOnTcp& servo) {
      return fmt::format(
          "{{name: {}, kind: modbus, address: \"tcp:127.0.0.1:{}\", registers: "
          "../../../bench/devices/profiles/modbus_servo_drive.yaml}}",
          name, servo.device.port());
    };
    text = schedules::With(text, "{name: can, kind: canopen, interface: in_process}",
                           device("driving", driving_) + "\n  - " + device("load", load_));
    try {
      const FieldMachine machine(ParseBenchFile(text, "real.yaml", Folder()), 80.0, {}, use);
      return "";
    } catch (const BenchError& error) {
      return error.what();
    }
  }
  static auto Enablings(ServoOnTcp& servo) {
    return std::ranges::count(servo.model.TakeWritten(), "control 1");
  }

  ServoOnTcp driving_;
  ServoOnTcp load_;
};

TEST_F(ModbusDrives, HaveTheirWatchdogsProvenBeforeAnythingMoves) {
  const std::string message = MessageOf(FieldMachine::Use::kMove);
  EXPECT_EQ(message.find("must not be enabled"), std::string::npos) << message;
  EXPECT_GT(Enablings(driving_), 0) << "at zero torque, with the brake on";
  EXPECT_GT(Enablings(load_), 0);
  EXPECT_TRUE(driving_.model.brake_engaged() && load_.model.brake_engaged());
}

TEST_F(ModbusDrives, AreNotUsedWithoutAWatchdog) {
  driving_.model.set_watchdog(ModbusServoModel::Watchdog::kAnything);
  EXPECT_EQ(
      MessageOf(FieldMachine::Use::kMove),
      "real.yaml: error: the driving servo must not be enabled: the drive did not stop within 480 ms after "
      "the "
      "last write while it was read, but did within 480 ms of complete silence: reading alone keeps its "
      "watchdog quiet (expected a watchdog that only writing keeps quiet)");
  EXPECT_TRUE(driving_.model.brake_engaged());
  EXPECT_NE(driving_.model.power(driving_.clock.Now()), protocols::PowerState::kOperationEnabled);
}

TEST_F(ModbusDrives, AreNotEnabledByALook) {
  driving_.model.set_watchdog(ModbusServoModel::Watchdog::kNever);
  const std::string message = MessageOf(FieldMachine::Use::kLook);
  EXPECT_EQ(message.find("must not be enabled"), std::string::npos) << message;
  EXPECT_EQ(Enablings(driving_) + Enablings(load_), 0);
}

}  // namespace
}  // namespace strainwave::bench::field_modbus_test
