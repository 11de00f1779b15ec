// SPDX-License-Identifier: Apache-2.0
// A bench of metal, whose metal is the device side within the program: real protocols, real time.
#include "bench/machines/field/field_machine.h"

#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <filesystem>
#include <fstream>
#include <sstream>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "analysis/units.h"
#include "bench/configuration/read_bench_file.h"
#include "bench/controller/make_program.h"
#include "bench/devices/can/in_process_can_bus.h"
#include "bench/errors/bench_error.h"
#include "bench/machines/device_side/device_side.h"
#include "bench/machines/plant_model_of.h"
#include "protocols/candump.h"
#include "tests/checkout.h"
#include "tests/daq/acquisition/emulated_iiod.h"
#include "tests/schedules/schedule_text.h"
#include "tests/simulation/bench_fixture.h"
#include "tests/simulation/field_bench.h"
#include "tests/simulation/program.h"
#include "tests/simulation/until.h"

namespace strainwave::bench::field_machine_test {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

TEST(DeviceSide, StandsSafeBeforeItsFirstStep) {
  const BenchDescription bench = ReadBenchFile(Folder() / "bench.yaml");
  InProcessCanBus bus({.ends = 3});
  DeviceSide devices(bench, PlantModelOf(bench, 80.0), {{"can", {&bus.end(1), &bus.end(2)}}});
  EXPECT_EQ(devices.SafeSince(), std::chrono::nanoseconds(0));
}

TEST(FieldMachine, SetsUpDrivesAndReadsEveryChannel) {
  FieldMachine machine(ReadBenchFile(Folder() / "bench.yaml"), 80.0, {});
  Sampler& sampler = machine.Devices().sampler;
  Until([&] { return sampler.Read().bad_channels == 0; });
  const Readings readings = sampler.Read();
  EXPECT_NEAR(readings.gear_temperature_degC, 21.0, 3.0);
  EXPECT_NEAR(readings.output_torque_Nm, 0.0, 1.0);
  EXPECT_FALSE(readings.quick_stop_pressed);
  for (const auto& state : machine.States()) EXPECT_TRUE(state.good) << state.device << ": " << state.state;
  EXPECT_EQ(machine.Troubles(), "");
  EXPECT_EQ(machine.MissingForStart(), "");
  EXPECT_TRUE(machine.device_side()->StandsSafe());
}

TEST(FieldMachine, ReadsThermometersOnASerialLine) {
  FieldMachine machine(ParseBenchFile(schedules::With(BenchText(), "modbus, address: \"tcp:127.0.0.1:0\"",
                                                      "modbus, address: \"rtu:a line of its own\""),
                                      "real.yaml", Folder()),
                       80.0, {});
  EXPECT_TRUE(machine.device_side()->AddressOf("thermometers").starts_with("rtu:/dev/pts/"));
  Sampler& sampler = machine.Devices().sampler;
  Until([&] { return sampler.Read().bad_channels == 0; });
  EXPECT_NEAR(sampler.Read().gear_temperature_degC, 21.0, 3.0);
}

// The driving servo turns; both encoders follow.
void ExpectToSeeTheShaftTurn(const BenchDescription& bench) {
  FieldMachine machine(bench, 80.0, {});
  BenchDevices devices = machine.Devices();
  Until([&] { return devices.sampler.Read().bad_channels == 0; });
  const double from_rad = devices.sampler.Read().input_angle_rad;
  devices.driving.Enable(DriveMode::kSpeed);
  devices.load.Enable(DriveMode::kTorque);
  Until([&] {
    const bool driving = BroughtUp(devices.driving);
    return BroughtUp(devices.load) && driving;
  });
  Until([&] {
    devices.driving.CommandSpeed(50.0);
    devices.load.CommandTorque(0.0);
    return devices.sampler.Read().input_angle_rad - from_rad > 40.0;
  });
  const Readings readings = devices.sampler.Read();
  EXPECT_NEAR(readings.input_speed_rad_per_s, 50.0, 2.0);
  EXPECT_NEAR(readings.output_angle_rad * 80.0, readings.input_angle_rad, 1.0);
  devices.driving.QuickStop();
  devices.load.QuickStop();
  Until([&] { return machine.device_side()->StandsSafe(); });
}

TEST(FieldMachine, TurnsTheShaftAndSeesItTurn) {
  ExpectToSeeTheShaftTurn(ReadBenchFile(Folder() / "bench.yaml"));
}

TEST(FieldMachine, TurnsEncodersThatCountAgainstTheShaft) {
  BenchDescription bench = ReadBenchFile(Folder() / "bench.yaml");
  bench.input_encoder.sign = bench.output_encoder.sign = -1;
  ExpectToSeeTheShaftTurn(bench);
}

TEST(FieldMachine, RecordsVibrationWithoutALoss) {
  FieldMachine machine(ReadBenchFile(Folder() / "bench.yaml"), 80.0, {});
  Sampler& sampler = machine.Devices().sampler;
  VibrationBlock block;
  sampler.StartVibration(6400.0);
  Until([&] {
    sampler.DrainVibration(block);
    return block.accel_x_m_per_s2.size() >= 6400;
  });
  sampler.StopVibration();
  sampler.DrainVibration(block);
  EXPECT_EQ(block.lost_samples, 0U);
  EXPECT_EQ(block.accel_motor_z_m_per_s2.size(), block.accel_x_m_per_s2.size());
  double squares = 0.0;
  for (const float value : block.accel_x_m_per_s2)
    squares += static_cast<double>(value) * static_cast<double>(value);
  EXPECT_GT(squares, 0.0);
  EXPECT_THROW(sampler.StartVibration(5000.0), std::invalid_argument) << "not a whole part of 12.8 kHz";
}

TEST(FieldMachine, WritesDownWhatGoesOverItsBusAndKeepsItAroundATrip) {
  const std::filesystem::path folder =
      std::filesystem::temp_directory_path() / fmt::format("strainwave-bus-log-{}", ::getpid());
  std::filesystem::create_directories(folder);
  {
    FieldMachine machine(ReadBenchFile(Folder() / "bench.yaml"), 80.0, {});
    machine.LogBuses(folder / "can");
    std::filesystem::path file;
    Until([&] {
      for (const auto& entry : std::filesystem::directory_iterator(folder / "can")) file = entry.path();
      return !file.empty() && std::filesystem::file_size(file) > 20'000;
    });
    machine.KeepBusLogs(folder / "trip");
    for (const std::string& note : machine.TakeNotes())
      EXPECT_NE(note.find(" SYNCs, "), std::string::npos) << note;
  }
  std::ifstream kept(folder / "trip.in_process.log");
  std::ostringstream text;
  text << kept.rdbuf();
  const auto frames = protocols::ParseCandump(text.str(), "trip.in_process.log");
  const auto count = [&](std::uint32_t id) {
    return std::ranges::count_if(frames, [&](const auto& logged) { return logged.frame.id == id; });
  };
  // SYNC, the master's heartbeat, the controlwords of both drives and what the drives say.
  for (const std::uint32_t id : {0x080U, 0x77FU, 0x201U, 0x202U, 0x281U, 0x282U, 0x701U, 0x702U}) {
    EXPECT_GT(count(id), 0) << std::hex << id;
  }
  std::filesystem::remove_all(folder);
}

TEST(FieldMachine, MountsTheBlankOfTheDeviceSideByItself) {
  FieldMachine machine(ReadBenchFile(Folder() / "bench.yaml"), 80.0, {});
  machine.MountBlank(true);
  BenchDevices devices = machine.Devices();
  Until([&] { return devices.sampler.Read().bad_channels == 0; });
  const Readings from = devices.sampler.Read();
  devices.driving.Enable(DriveMode::kSpeed);
  devices.load.Enable(DriveMode::kTorque);
  Until([&] {
    const bool driving = BroughtUp(devices.driving);
    return BroughtUp(devices.load) && driving;
  });
  constexpr double kSpeed_rad_per_s = 5.0;
  Until([&] {
    devices.driving.CommandSpeed(kSpeed_rad_per_s);
    devices.load.CommandTorque(0.0);
    return devices.sampler.Read().input_angle_rad - from.input_angle_rad > 2.0;
  });
  const Readings turned = devices.sampler.Read();
  // The output turns with the input, not by the gear's ratio; samples of both are less than 40 ms apart.
  EXPECT_NEAR(turned.output_angle_rad - from.output_angle_rad, turned.input_angle_rad - from.input_angle_rad,
              0.04 * kSpeed_rad_per_s);
  devices.driving.QuickStop();
  devices.load.QuickStop();
  Until([&] { return machine.device_side()->StandsSafe(); });
  machine.MountBlank(false);
}

std::string MessageOf(std::string_view from, std::string_view to) {
  try {
    const FieldMachine machine(ParseBenchFile(schedules::With(BenchText(), from, to), "real.yaml", Folder()),
                               80.0, {});
    return "";
  } catch (const BenchError& error) {
    return error.what();
  }
}

TEST(FieldMachine, SaysWhatIsMissing) {
  EXPECT_EQ(MessageOf("interface: in_process", "interface: nocan7").substr(0, 17), "real.yaml: error:");
  EXPECT_EQ(
      MessageOf("source: torque_Nm", "source: torque_lbf"),
      "real.yaml: error: channel 'torque_lbf' does not end in its unit (must in _deg, _arcmin, _rad, _rpm, "
      "_rad_per_s, _Nm, _degC or _m_per_s2)");
  EXPECT_EQ(MessageOf("source: gear_temperature_degC", "source: oil_temperature_degC"),
            "real.yaml: error: line 51: device thermometers has no register oil_temperature_degC (must be "
            "one of its "
            "map)");
}

TEST(FieldMachine, ConnectsTheShuntOverModbus) {
  FieldMachine machine(ReadBenchFile(Folder() / "bench.yaml"), 80.0, {});
  Sampler& sampler = machine.Devices().sampler;
  Until([&] { return sampler.Read().bad_channels == 0; });
  sampler.ConnectShunt(true);
  // 50 Nm by its certificate; no torque is on the gear.
  Until([&] { return sampler.Read().output_torque_Nm > 49.0; });
  EXPECT_NEAR(sampler.Read().output_torque_Nm, 50.0, 1.0);
  sampler.ConnectShunt(false);
  Until([&] { return sampler.Read().output_torque_Nm < 1.0; });
}

// Two encoders in motion, the second one read 3 ms before the first, and a torque that is read later than
// both.
TEST(FieldSampler, GivesEachValueAsItWasSampledWithItsTime) {
  const MonotonicClock clock;
  FieldChannels channels;
  const auto at = [](Channel channel) { return static_cast<std::size_t>(channel); };
  const auto sampled = [&clock](double value, milliseconds time) {
    return [&clock, value, time] { return ChannelValue{value, clock.Now(), true, time}; };
  };
  channels.channels[at(Channel::kInputAngle)] = sampled(523.5, milliseconds(-1));
  channels.channels[at(Channel::kOutputAngle)] = sampled(6.54, milliseconds(-4));
  channels.channels[at(Channel::kInputSpeed)] = sampled(104.72, milliseconds(-7));
  channels.channels[at(Channel::kOutputTorque)] = sampled(12.0, milliseconds(-30));
  channels.channels[at(Channel::kMotorTorque)] = sampled(0.25, milliseconds(-5));
  channels.channels[at(Channel::kGearTemperature)] = sampled(20.0, milliseconds(-900));
  FieldSampler sampler(channels, clock);
  const Readings readings = sampler.Read();
  EXPECT_EQ(readings.input_angle_rad, 523.5);
  EXPECT_EQ(readings.input_angle_time, milliseconds(-1)) << "not when the sample came";
  EXPECT_EQ(readings.output_angle_rad, 6.54) << "as it was sampled";
  EXPECT_EQ(readings.output_angle_time, milliseconds(-4));
  EXPECT_EQ(readings.angles_time(), milliseconds(-4));
  EXPECT_EQ(readings.input_speed_time, milliseconds(-7));
  EXPECT_EQ(readings.torque_time, milliseconds(-30));
  EXPECT_EQ(readings.motor_torque_time, milliseconds(-5));
}

// The encoders of the device side are read 1 ms apart, which is 4.5 arcmin at 1000 rpm; its drives have the
// window and the patience for following errors of the profile that comes with the program.
TEST(FieldMachine, MeasuresTheSkewOfItsEncodersInASweepAt1000Rpm) {
  const ScratchFolder folder;
  std::ifstream file(Folder() / "drive.yaml");
  std::ostringstream profile;
  profile << file.rdbuf();
  const std::string root = SourceFolder();
  std::string text = schedules::With(profile.str(), "../../../", root + "/");
  text = schedules::With(text, "following_error_window: 720 deg", "following_error_window: 270 deg");
  text = schedules::With(text, "following_error_time: 1 s", "following_error_time: 50 ms");
  std::ofstream(folder / "drive.yaml") << text;
  std::string bench = BenchText();
  for (int i = 0; i < 2; ++i) {
    bench = schedules::With(bench, "profile: drive.yaml", "profile: " + (folder / "drive.yaml").string());
  }
  bench = schedules::With(bench, "  seed: 1", "  seed: 1\n  time_skew: 1 ms");
  const BenchDescription description = ParseBenchFile(bench, "skewed.yaml", Folder());
  FieldMachine machine(description, 80.0, {});
  BenchDevices devices = machine.Devices();
  Until([&] { return devices.sampler.Read().bad_channels == 0; });

  schedules::TransmissionErrorSweep sweep = TestSweep();
  sweep.step_rad = RadFromDeg(10.0);
  sweep.steps = 12;
  sweep.input_speed_rad_per_s = RadPerSFromRpm(1000.0);
  RunnerSettings settings = TestSettings();
  settings.own_thread = true;
  settings.stale_after_s = 1.0;
  std::atomic<StopRequest> request{StopRequest::kNone};
  PhaseRunner runner(devices, settings, request);
  const auto program = MakeProgram(sweep, TestSpecimen(), 0.0, SweepPeriod_s(description));
  const PhaseOutcome outcome = runner.Run(*program, NoHeartbeat);
  ASSERT_EQ(outcome.reason.cause, StopCause::kNone) << Describe(outcome.reason) << machine.Troubles();
  const daq::Record record = outcome.records.at(0).record;
  const double skew_us = daq::NumberFromText(record.Metadata("encoder_skew_us").value()).value();
  const double error_us = daq::NumberFromText(record.Metadata("encoder_skew_se_us").value()).value();
  EXPECT_NEAR(skew_us, 1000.0, 5.0 * error_us);
  EXPECT_LT(error_us, 20.0) << "24 moves; a whole sweep has 720";
  EXPECT_EQ(record.Metadata("encoder_skew_taken_out"), "true");
}

TEST(FieldMachine, ReadsAccelerometersFromAnIioContext) {
  const daq::acquisition::EmulatedIiod iiod({"--in-real-time", "--blocks", "100000"});
  std::string text = BenchText();
  text =
      schedules::With(text, R"({name: accelerometers, kind: stream, address: "tcp:127.0.0.1:0"})",
                      "{name: accelerometers, kind: iio, address: \"" + iiod.uri() + "\", device: adxl355}");
  text = schedules::With(text, "source: accel_x_m_per_s2", "source: accel_x");
  text = schedules::With(text, "source: accel_y_m_per_s2", "source: accel_y");
  for (const char* name : {"accel_z", "accel_motor_z"}) {
    for (const std::string& line :
         {std::string("  - {name: ") + name + ",", std::string("  - {channel: ") + name}) {
      const std::size_t from = text.find(line);
      text.erase(from, text.find('\n', from) - from + 1);
    }
  }
  FieldMachine machine(ParseBenchFile(text, "iio.yaml", Folder()), 80.0, {});
  Sampler& sampler = machine.Devices().sampler;
  Until([&] { return sampler.Read().bad_channels == 0; });
  VibrationBlock block;
  sampler.StartVibration(1000.0);
  Until([&] {
    sampler.DrainVibration(block);
    return block.accel_x_m_per_s2.size() >= 500;
  });
  EXPECT_EQ(block.lost_samples, 0U);
  // Sample n of the device is n counts of 0.000038245 m/s²; of the second channel it is -n.
  for (std::size_t i = 1; i < 500; ++i) {
    EXPECT_NEAR(block.accel_x_m_per_s2[i] - block.accel_x_m_per_s2[i - 1], 0.000038245, 1e-6);
    EXPECT_EQ(block.accel_y_m_per_s2[i], -block.accel_x_m_per_s2[i]);
  }
}

}  // namespace
}  // namespace strainwave::bench::field_machine_test
