// SPDX-License-Identifier: Apache-2.0
// The sections of a bench file that say which real devices play its parts.
#include <chrono>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "bench/configuration/commissioning_file.h"
#include "bench/configuration/read_bench_file.h"
#include "tests/bench/bench_message.h"
#include "tests/schedules/schedule_text.h"

namespace strainwave::bench::device_sections_test {
namespace {

using schedules::With;

std::string RealBench() {
  return R"(bench: 1
name: real
simulated: false
driving_servo:
  peak_torque: 7 Nm
  peak_speed: 3000 rpm
  max_acceleration: 2000 rad/s2
  drive: {device: can, node: 1, profile: drives/servo.yaml}
load_servo:
  peak_torque: 7 Nm
  peak_speed: 6000 rpm
  max_acceleration: 2000 rad/s2
  drive: {device: load}
torque_transducer: {range: 100 Nm}
input_encoder: {counts_per_rev: 1048576, accuracy: 20 arcsec}
output_encoder: {counts_per_rev: 268435456, accuracy: 2.5 arcsec}
accelerometers:
  - name: accel_x
devices:
  - {name: can, kind: canopen, interface: can0}
  - {name: load, kind: modbus, address: "tcp:10.0.0.2:502", unit: 3, registers: load.yaml}
  - {name: front, kind: stream, address: "tcp:127.0.0.1:5025"}
  - {name: key, kind: pendant, profile: pendant.yaml}
  - {name: eye, kind: camera, address: /dev/video0}
channels:
  - {channel: input_angle, device: front, source: input_deg}
  - {channel: output_angle, device: front, source: output_deg}
  - {channel: output_torque, device: front, source: torque_Nm}
  - {channel: gear_temperature, device: load, source: gear_degC}
  - {channel: accel_x, device: front, source: accel_x_m_per_s2}
)";
}

std::string MessageOf(std::string_view from, std::string_view to) {
  return BenchMessageOf(With(RealBench(), from, to), "real.yaml", "lab");
}

TEST(DeviceSections, NameEveryDeviceAndWhereItIs) {
  const BenchDescription bench = ParseBenchFile(RealBench(), "real.yaml", "lab");
  ASSERT_EQ(bench.devices.size(), 5U);
  EXPECT_EQ(bench.devices[0].kind, DeviceDescription::Kind::kCanopen);
  EXPECT_EQ(bench.devices[0].address, "can0");
  EXPECT_EQ(bench.devices[1].kind, DeviceDescription::Kind::kModbus);
  EXPECT_EQ(bench.devices[1].unit, 3);
  EXPECT_EQ(bench.devices[1].file, "lab/load.yaml");
  EXPECT_EQ(bench.devices[4].kind, DeviceDescription::Kind::kCamera);
  EXPECT_EQ(bench.driving_servo.drive.device, "can");
  EXPECT_EQ(bench.driving_servo.drive.node, 1);
  EXPECT_EQ(bench.driving_servo.drive.profile, "lab/drives/servo.yaml");
  EXPECT_EQ(bench.load_servo.drive.device, "load");
  ASSERT_EQ(bench.channels.size(), 5U);
  EXPECT_EQ(bench.channels[3].channel, "gear_temperature");
  EXPECT_EQ(bench.channels[3].device, "load");
  EXPECT_EQ(bench.channels[3].source, "gear_degC");
}

TEST(DeviceSections, NameATorqueAmplifierAndATemperatureController) {
  const auto with = [](const std::string& device) {
    return With(RealBench(), "  - {name: key,", "  - {name: more, " + device + "}\n  - {name: key,");
  };
  const std::string amplifier =
      "kind: torque_amplifier, address: \"tcp:10.0.0.4:502\", registers: torque.yaml";
  const std::string chamber =
      "kind: temperature_controller, address: \"rtu:/dev/ttyUSB0\", unit: 2, parity: even, registers: c.yaml";
  const DeviceDescription first = ParseBenchFile(with(amplifier), "real.yaml", "lab").devices.at(3);
  EXPECT_EQ(first.kind, DeviceDescription::Kind::kTorqueAmplifier);
  EXPECT_EQ(first.address, "tcp:10.0.0.4:502");
  EXPECT_EQ(first.file, "lab/torque.yaml");
  EXPECT_FALSE(first.set_point_degC);
  const DeviceDescription second =
      ParseBenchFile(with(chamber + ", set_point: 40 degC"), "real.yaml", "lab").devices.at(3);
  EXPECT_EQ(second.kind, DeviceDescription::Kind::kTemperatureController);
  EXPECT_EQ(second.unit, 2);
  EXPECT_EQ(second.connection.parity, 'E');
  EXPECT_EQ(second.set_point_degC, 40.0);
  EXPECT_FALSE(ParseBenchFile(with(chamber), "real.yaml", "lab").devices.at(3).set_point_degC);
  EXPECT_EQ(MessageOf("{name: key,", "{name: more, " + amplifier + ", set_point: 40 degC}\n  - {name: key,"),
            "real.yaml:23:95: error: unknown key 'set_point' (expected name, kind, address, unit, registers, "
            "answer_time)");
}

TEST(DeviceSections, RefuseADriveWithoutADevice) {
  EXPECT_EQ(
      MessageOf("  drive: {device: load}\n", ""),
      "real.yaml:18:1: error: load_servo has no drive (expected load_servo.drive with device, and node and "
      "profile where the device is a CAN bus)");
  EXPECT_EQ(MessageOf("{device: load}", "{device: loda}"),
            "real.yaml:13:19: error: device = loda is not among the devices (expected the name of one)");
  EXPECT_EQ(MessageOf("{device: load}", "{device: front}"),
            "real.yaml:13:19: error: device = front drives nothing (expected one of kind canopen or modbus)");
  EXPECT_EQ(MessageOf("{device: load}", "{device: can, node: 2}"),
            "real.yaml:13:19: error: device = can is a CAN bus (expected node and profile beside it)");
}

TEST(DeviceSections, RefuseChannelsThatLeadNowhere) {
  EXPECT_EQ(
      MessageOf("channel: accel_x,", "channel: accel_y,"),
      "real.yaml:25:1: error: channels has no accel_x (expected one for every accelerometer)\n"
      "real.yaml:30:15: error: channel = accel_y is not one of the bench's (expected one of input_angle, "
      "output_angle, output_torque, gear_temperature, input_speed, motor_torque, ambient_temperature, "
      "accel_x)");
  EXPECT_EQ(MessageOf("channel: accel_x, device: front", "channel: accel_x, device: key"),
            "real.yaml:30:32: error: device = key has no channels (expected one of kind modbus, "
            "torque_amplifier, temperature_controller, stream, iio or hid)");
  EXPECT_EQ(
      MessageOf("channel: output_angle, device: front", "channel: output_angle, device: load"),
      "real.yaml:27:37: error: device = load does not date its samples (expected one of kind stream or iio "
      "for an angle)");
  EXPECT_EQ(
      MessageOf("  - {channel: output_torque, device: front, source: torque_Nm}\n", ""),
      "real.yaml:25:1: error: channels has no output_torque (expected {channel: output_torque, device: …, "
      "source: …})");
  EXPECT_EQ(
      MessageOf("channel: output_angle", "channel: input_angle"),
      "real.yaml:25:1: error: channels has no output_angle (expected {channel: output_angle, device: …, "
      "source: …})\n"
      "real.yaml:27:15: error: channel 'input_angle' is there twice (expected once; it is already on line "
      "26)");
}

TEST(DeviceSections, RefuseDevicesOfOneName) {
  EXPECT_EQ(MessageOf("name: eye", "name: key"),
            "real.yaml:24:12: error: two devices are named 'key' (expected a name of its own)");
}

TEST(DeviceSections, DoNotStandBesideASimulatedBench) {
  EXPECT_EQ(MessageOf("simulated: false", "simulated: true"),
            "real.yaml:3:12: error: a simulated bench has no devices (expected 'simulated: false', or no "
            "devices)");
}

constexpr std::string_view kTcp = "address: \"tcp:10.0.0.2:502\", unit: 3";

TEST(DeviceSections, SayHowAModbusDeviceIsToBeTalkedTo) {
  const BenchDescription usual = ParseBenchFile(RealBench(), "real.yaml", "lab");
  EXPECT_FALSE(usual.devices[1].connection.answer_time || usual.devices[1].connection.baud);
  const BenchDescription bench = ParseBenchFile(
      With(RealBench(), kTcp,
           "address: \"rtu:/dev/ttyUSB0\", answer_time: 1.5 s, retries: 0, answers_echo: false, baud: 9600, "
           "parity: none, stop_bits: 2"),
      "real.yaml", "lab");
  const ModbusConnection& connection = bench.devices[1].connection;
  EXPECT_EQ(connection.answer_time, std::chrono::milliseconds(1500));
  EXPECT_EQ(connection.retries, 0);
  EXPECT_EQ(connection.answers_echo, false);
  EXPECT_EQ(connection.baud, 9600);
  EXPECT_EQ(connection.parity, 'N');
  EXPECT_EQ(connection.stop_bits, 2);
}

TEST(DeviceSections, WantSamplesOfAnAccelerometer) {
  EXPECT_EQ(
      MessageOf("channel: accel_x, device: front", "channel: accel_x, device: load"),
      "real.yaml:30:32: error: device = load sends no samples (expected one of kind stream or iio for an "
      "accelerometer)");
}

TEST(DeviceSections, RefuseConnectionsThatCannotBe) {
  EXPECT_EQ(
      MessageOf(kTcp, "address: \"tcp:10.0.0.2:502\", baud: 9600"),
      "real.yaml:21:67: error: baud belongs to a serial line (expected address: \"rtu:PATH\", or no baud)");
  EXPECT_EQ(MessageOf(kTcp, "address: \"tcp:10.0.0.2:502\", answer_time: 2 min"),
            "real.yaml:21:74: error: answer_time = 120 s is not usable (expected 1 ms to 60 s)");
  EXPECT_EQ(MessageOf(kTcp, "address: \"tcp:10.0.0.2:502\", retries: 11"),
            "real.yaml:21:70: error: retries = 11: out of range (expected a whole number from 0 to 10)");
  EXPECT_EQ(MessageOf(kTcp, "address: \"rtu:/dev/ttyUSB0\", parity: mark"),
            "real.yaml:21:69: error: parity = mark: not known (expected none, even or odd)");
}

MeasuredStop SomeStop() {
  return {"load_servo", "vendor 00005357h, serial 00000002h", 0.104, 0.131, "2026-03-01T12:00:00Z"};
}

TEST(CommissioningFile, IsReadAsItWasWritten) {
  const std::string text = CommissioningText({SomeStop()});
  const std::vector<MeasuredStop> stops = ParseCommissioningFile(text, "real.commissioned.yaml");
  ASSERT_EQ(stops.size(), 1U);
  EXPECT_EQ(stops[0].servo, "load_servo");
  EXPECT_EQ(stops[0].identity, "vendor 00005357h, serial 00000002h");
  EXPECT_DOUBLE_EQ(stops[0].left_enabled_s, 0.104);
  EXPECT_DOUBLE_EQ(stops[0].stood_s, 0.131);
  EXPECT_EQ(stops[0].measured, "2026-03-01T12:00:00Z");
  EXPECT_EQ(CommissioningFileOf("lab/real.yaml"), "lab/real.commissioned.yaml");
  EXPECT_EQ(CommissioningFileOf("/opt/strainwave/bench/examples/in_process.yaml"),
            "/opt/strainwave/campaigns/in_process.commissioned.yaml")
      << "an example stays as it came";
  try {
    ParseCommissioningFile(With(text, "131 ms", "131"), "real.commissioned.yaml");
    FAIL() << "a time without a unit was taken";
  } catch (const BenchFileError& error) {
    EXPECT_TRUE(std::string(error.what()).starts_with("real.commissioned.yaml:4:")) << error.what();
  }
}

TEST(CommissioningFile, SpeaksAgainstABenchItWasNotMeasuredOn) {
  const MeasuredStop stop = SomeStop();
  EXPECT_EQ(JudgeStopTime("load_servo", &stop, stop.identity, 2.0).words, "");
  EXPECT_EQ(JudgeStopTime("load_servo", &stop, "", 2.0).words, "") << "a drive that does not tell";
  const StopTimeFinding never = JudgeStopTime("load_servo", nullptr, stop.identity, 2.0);
  EXPECT_FALSE(never.refuses);
  EXPECT_EQ(
      never.words,
      "load_servo: how long it takes to stop when this program is gone was never measured (measure it with "
      "strainwave bench commission)");
  const StopTimeFinding other = JudgeStopTime("load_servo", &stop, "vendor 00005357h, serial 00000003h", 2.0);
  EXPECT_TRUE(other.refuses);
  EXPECT_EQ(
      other.words,
      "load_servo: the time to stop was measured on another drive: vendor 00005357h, serial 00000002h (this "
      "one is vendor 00005357h, serial 00000003h; measure it with strainwave bench commission)");
  const StopTimeFinding slow = JudgeStopTime("load_servo", &stop, stop.identity, 0.12);
  EXPECT_TRUE(slow.refuses);
  EXPECT_EQ(
      slow.words,
      "load_servo: it took 131 ms to stop when this program was gone, longer than longest_stop_time, 120 ms "
      "(check its supervision and its ramps, then measure it with strainwave bench commission)");
}

TEST(DeviceSections, SwitchTheShuntByAModbusDevice) {
  const auto with = [](const char* device) {
    return schedules::With(
        RealBench(), "torque_transducer: {",
        std::string("torque_transducer: {shunt: {device: ") + device + ", source: bridge}, ");
  };
  const BenchDescription bench = ParseBenchFile(with("load"), "real.yaml", "lab");
  EXPECT_EQ(bench.transducer.shunt.device, "load");
  EXPECT_EQ(bench.transducer.shunt.source, "bridge");
}

}  // namespace
}  // namespace strainwave::bench::device_sections_test
